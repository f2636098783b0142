#include "slam/sources/euroc.h"

#include <fmt/core.h>

#include <optional>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/calibration/sensor_yaml.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_list.h"
#include "slam/sources/recorded_sequence.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

constexpr double kSameTime = 1e-3;  // seconds, between the images of a pair

// T_WB, wherever it is written; empty where it is nowhere.
Trajectory find_ground_truth(const fs::path& mav, Notes* notes) {
  const fs::path estimate = mav / "state_groundtruth_estimate0" / "data.csv";
  if (is_present(estimate)) return read_euroc_trajectory(estimate, notes);
  const fs::path motion_capture = mav / "mocap0" / "data.csv";
  if (is_present(motion_capture)) return read_euroc_trajectory(motion_capture, notes);
  for (const fs::path& file : {mav.parent_path() / "groundtruth_tum.txt", mav / "groundtruth_tum.txt"}) {
    if (is_present(file)) return read_tum_trajectory(file, notes);
  }
  return {};
}

struct RawPair {
  LensCamera left, right;
  SE3 T_right_left;
  std::string place;                    // of T_right_left, for messages
  std::optional<Mounting> on_the_body;  // of the left camera
};

// Of TUM-VI, whose lenses are in Kalibr's file. The body is the inertial sensor.
RawPair read_camchain(const fs::path& path, Notes& notes) {
  const CameraFile file = read_camera_file(path);
  if (file.rectified) throw InputError(path.string(), "cam0 and cam1", "one camera");
  RawPair pair{file.left, file.right, file.T_right_left, file.place, std::nullopt};
  if (!file.mountings.empty()) {
    pair.on_the_body = file.mountings.front();
  } else {
    notes.push_back(fmt::format("{}: has no T_cam_imu; ground truth is taken for that of the left camera",
                                path.string()));
  }
  return pair;
}

RawPair read_cameras(const fs::path& mav, Notes& notes) {
  const fs::path left_file = mav / "cam0" / "sensor.yaml", right_file = mav / "cam1" / "sensor.yaml";
  if (!is_present(left_file)) {
    for (const fs::path& chain :
         {mav.parent_path() / "dso" / "camchain.yaml", mav.parent_path() / "camchain.yaml"}) {
      if (is_present(chain)) return read_camchain(chain, notes);
    }
  }
  const EurocCamera left = read_euroc_camera(left_file), right = read_euroc_camera(right_file);
  return {left.lens, right.lens, right.T_BS.inverse() * left.T_BS, right_file.string(),
          Mounting{"body", left.T_BS}};
}

}  // namespace

bool looks_like_euroc(const fs::path& path) {
  return is_folder(path / "mav0") || is_present(path / "cam0" / "sensor.yaml");
}

std::unique_ptr<StereoDataset> open_euroc(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  const fs::path mav = fs::canonical(is_folder(path / "mav0") ? path / "mav0" : path);
  const fs::path folders[] = {mav / "cam0", mav / "cam1"};
  Recording recording;
  const RawPair pair = read_cameras(mav, recording.notes);
  const StereoRectification rectification =
      rectify_stereo(pair.left, pair.right, pair.T_right_left, pair.place);

  const double pair_within = options.pair_within.value_or(kSameTime);
  recording.name = "EuRoC " + mav.parent_path().filename().string();
  recording.place = mav.string();
  recording.camera = rectification.camera;
  recording.left = rectification.left;
  recording.right = rectification.right;
  recording.colour = colour_of(options.cameras, nn::ImageColour::grey);
  const ImageList left_list = read_euroc_image_list(folders[0] / "data.csv");
  const ImageList right_list = read_euroc_image_list(folders[1] / "data.csv");
  const std::vector<ListedImage>&left_images = left_list.images, &right_images = right_list.images;
  for (std::string& note : joined_notes(left_list, right_list)) recording.notes.push_back(std::move(note));
  note_unused_rate(options.frame_rate, folders[0] / "data.csv", recording.notes);
  const PairingTexts texts{mav.string(), "images of cam0 and cam1 with the same times (at most {:g} s apart)",
                           "images of cam0", "of cam1"};
  for (const auto& [l, r] : pair_by_time(left_list, right_list, pair_within, texts, recording.notes)) {
    recording.frames.push_back({static_cast<int>(recording.frames.size()), left_images[l].timestamp,
                                folders[0] / "data" / left_images[l].name,
                                folders[1] / "data" / right_images[r].name});
  }
  SE3 T_B_rectified{rectification.R_rectified_left.transpose(), Eigen::Vector3d::Zero()};
  if (pair.on_the_body) {
    T_B_rectified = pair.on_the_body->T_frame_camera * T_B_rectified;
    recording.mountings.push_back({pair.on_the_body->frame, T_B_rectified});
  }
  recording.ground_truth = find_ground_truth(mav, &recording.notes);
  for (TimedPose& pose : recording.ground_truth) pose.T_wc = pose.T_wc * T_B_rectified;
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
