#include "slam/sources/tum.h"

#include <fmt/core.h>

#include <optional>
#include <string>

#include "nn/base/error.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_list.h"
#include "slam/sources/openloris.h"
#include "slam/sources/recorded_sequence.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// Seconds between colour and depth: more than half a frame of 30 Hz, so that nearly every image finds its
// partner.
constexpr double kSameTime = 0.02;

struct KnownCamera {
  const char* names[2];
  LensCamera lens;
};

// TUM's own calibration of its three colour cameras ("Intrinsic Camera Calibration of the Kinect").
const KnownCamera kCameras[] = {
    {{"freiburg1", "fr1"},
     {517.306408,
      516.469215,
      318.643040,
      255.313989,
      LensModel::radial_tangential,
      {0.262383, -0.953104, -0.005358, 0.002628, 1.163314},
      640,
      480}},
    {{"freiburg2", "fr2"},
     {520.908620,
      521.007327,
      325.141442,
      249.701764,
      LensModel::radial_tangential,
      {0.231222, -0.784899, -0.003257, -0.000105, 0.917205},
      640,
      480}},
    {{"freiburg3", "fr3"}, {535.4, 539.2, 320.1, 247.6, LensModel::radial_tangential, {}, 640, 480}},
    // Bonn's dynamic data set, whose page has the numbers.
    {{"rgbd_bonn", "rgbd_bonn"},
     {542.822841,
      542.576870,
      315.593520,
      237.756098,
      LensModel::radial_tangential,
      {0.039903, -0.099343, -0.000730, -0.000144, 0.0},
      640,
      480}},
};

// What the folder was called by who asked for it, perhaps a link's own name, and what it is called where it
// lies.
std::string names_of(const fs::path& asked, const fs::path& folder) {
  fs::path own = fs::absolute(asked).lexically_normal();
  if (!own.has_filename()) own = own.parent_path();
  if (own.filename() == folder.filename()) return folder.filename().string();
  return own.filename().string() + ", " + folder.filename().string();
}

// The two lists, and what the layout is called.
struct Lists {
  const char* colour;
  const char* depth;
  const char* layout;
};
constexpr Lists kTum{"rgb.txt", "depth.txt", "TUM RGB-D"};
constexpr Lists kOpenLoris{"color.txt", "aligned_depth.txt", "OpenLORIS"};

bool is_openloris(const fs::path& folder) {
  return is_present(folder / kOpenLoris.colour) && is_present(folder / kOpenLoris.depth);
}

CameraFile find_camera(const fs::path& folder, const std::string& names) {
  if (is_present(folder / "calibration.yaml")) {
    CameraFile file = read_camera_file(folder / "calibration.yaml");
    if (file.sensor != Sensor::rgbd) {
      throw InputError((folder / "calibration.yaml").string(), "an RGB-D camera (sensor: rgbd)",
                       "a stereo camera");
    }
    return file;
  }
  if (is_openloris(folder)) return read_openloris_camera(folder / "sensors.yaml");
  // ETH3D's.
  if (is_present(folder / "calibration.txt")) return read_camera_file(folder / "calibration.txt");
  for (const KnownCamera& known : kCameras) {
    if (names.find(known.names[0]) == std::string::npos && names.find(known.names[1]) == std::string::npos)
      continue;
    CameraFile file;
    file.sensor = Sensor::rgbd;
    file.left = known.lens;
    file.baseline = kNominalBaseline;
    file.place = folder.string();
    return file;
  }
  throw InputError(folder.string(),
                   "a calibration.yaml, or a folder name with freiburg1, freiburg2, freiburg3 or rgbd_bonn",
                   fmt::format("neither in '{}'", names));
}

// OpenLORIS' truth is the path of the robot's base: where its camera stands there makes it the camera's.
void carry_to_camera(Recording& recording) {
  if (recording.mountings.empty()) {
    recording.notes.emplace_back(
        "the ground truth is the path of the robot's base, and no trans_matrix.yaml says where its camera "
        "is: errors have the way between them in");
    return;
  }
  const SE3& T_base_camera = recording.mountings.front().T_frame_camera;
  for (TimedPose& pose : recording.ground_truth) pose.T_wc = pose.T_wc * T_base_camera;
}

}  // namespace

bool looks_like_tum(const fs::path& path) {
  return is_present(path / "rgb.txt") || is_openloris(path) ||
         (is_folder(path / "rgb") && !is_present(path / "calibration.yaml"));
}

std::unique_ptr<StereoDataset> open_tum(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  const fs::path folder = fs::canonical(path);
  const std::string name = folder.filename().string();
  const Lists& lists = is_openloris(folder) ? kOpenLoris : kTum;
  const ImageList colour_list = read_tum_image_list(folder / lists.colour);
  const ImageList depth_list = read_tum_image_list(folder / lists.depth);
  const std::vector<ListedImage>&colour = colour_list.images, &depth = depth_list.images;
  const CameraFile file = find_camera(folder, names_of(path, folder));
  RecordedCamera camera = make_camera(file);
  if (const fs::path mounting = folder / "trans_matrix.yaml"; is_openloris(folder) && is_present(mounting)) {
    if (const auto T_base_camera = read_openloris_mounting(mounting))
      camera.stands({"base_link", *T_base_camera});
  }

  const double pair_within = options.pair_within.value_or(kSameTime);
  Recording recording;
  recording.name = fmt::format("{} {}", lists.layout, name);
  recording.notes = joined_notes(colour_list, depth_list);
  note_unused_rate(options.frame_rate, folder / lists.colour, recording.notes);
  recording.place = folder.string();
  recording.sensor = Sensor::rgbd;
  recording.camera = camera.camera;
  recording.mountings = camera.mountings;
  recording.left = camera.left;
  recording.images = file_images(file.depth_factor);
  recording.notes.insert(recording.notes.end(), file.notes.begin(), file.notes.end());
  recording.colour = colour_of(options.cameras, nn::ImageColour::bgr);
  const PairingTexts texts{folder.string(), "colour and depth images within {:g} s of each other", "colour",
                           "depth images"};
  for (const auto& [c, d] : pair_by_time(colour_list, depth_list, pair_within, texts, recording.notes)) {
    recording.frames.push_back({static_cast<int>(recording.frames.size()), colour[c].timestamp,
                                folder / colour[c].name, folder / depth[d].name,
                                depth[d].timestamp - colour[c].timestamp});
  }
  if (is_present(folder / "groundtruth.txt")) {
    recording.ground_truth = read_tum_trajectory(folder / "groundtruth.txt", &recording.notes);
    if (is_openloris(folder)) carry_to_camera(recording);
  }
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
