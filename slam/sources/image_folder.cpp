#include "slam/sources/image_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_pairs.h"
#include "slam/sources/named_times.h"
#include "slam/sources/recorded_sequence.h"
#include "slam/sources/time_list.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// Lines of a file about the images, of which some have no partner.
struct LinePlace {
  const char* of = nullptr;  // whose place in its order says the line
  std::size_t (*line)(const ImagePairs&, std::size_t pair) = nullptr;
};

// By the number of lines: one for every left image, for every name in either folder, or for every pair.
// Throws InputError where it is neither.
LinePlace find_lines(const fs::path& file, std::size_t lines, const char* what, const ImagePairs& images) {
  if (lines == images.first.size())
    return {"left image", [](const ImagePairs& i, std::size_t pair) { return i.pairs[pair].first; }};
  if (lines == images.names)
    return {"name in either folder",
            [](const ImagePairs& i, std::size_t pair) { return i.pairs[pair].place; }};
  if (lines == images.pairs.size())
    return {"image with a partner", [](const ImagePairs&, std::size_t pair) { return pair; }};
  std::string expected = fmt::format("{} of {} frames", what, images.first.size());
  if (images.alone > 0) expected += fmt::format(" (or of the {} with a partner)", images.pairs.size());
  throw InputError(file.string(), expected, fmt::format("{}", lines));
}

std::vector<double> read_times(const fs::path& file, const ImagePairs& images, Recording& recording) {
  Notes& notes = recording.notes;
  const std::vector<double> all = read_time_list(file, notes);
  const LinePlace place = find_lines(file, all.size(), "times", images);
  if (images.alone > 0) notes.push_back(fmt::format("{}: one line for every {}", file.string(), place.of));
  std::vector<double> times;
  for (std::size_t pair = 0; pair < images.pairs.size(); ++pair)
    times.push_back(all[place.line(images, pair)]);
  return times;
}

// `asked_rate`: --rate; `rate`: that of the calibration.
void set_times(const fs::path& folder, const ImagePairs& images, std::optional<double> asked_rate,
               std::optional<double> rate, Recording& recording) {
  const fs::path file = folder / "times.txt";
  const bool has_file = is_present(file);
  Notes of_names;
  std::vector<double> times =
      has_file ? read_times(file, images, recording) : times_in_names(images, of_names);
  recording.notes.insert(recording.notes.end(), of_names.begin(), of_names.end());
  if (times.empty()) {
    if (asked_rate) rate = asked_rate;
    if (!rate) {
      throw InputError(
          folder.string(),
          "times.txt, images named by their times, or 'rate: HZ' in calibration.yaml (or --rate HZ)",
          of_names.empty() ? "none of them" : of_names.back());
    }
    if (!(*rate > 0.0)) throw UsageError(fmt::format("frame rate {:g}: expected more than 0 Hz", *rate));
    times = places_in_names(images);
    for (double& time : times) time /= *rate;
  } else {
    note_unused_rate(asked_rate, has_file ? file : images.first.front().path.parent_path(), recording.notes);
  }
  for (std::size_t i = 0; i < times.size(); ++i) recording.frames[i].timestamp = times[i];
}

Trajectory find_ground_truth(const fs::path& folder, const ImagePairs& images,
                             const std::vector<RecordedFrame>& frames, Notes* notes) {
  if (is_present(folder / "groundtruth.txt")) return read_tum_trajectory(folder / "groundtruth.txt", notes);
  const fs::path file = folder / "poses.txt";
  if (!is_present(file)) return {};
  const std::vector<SE3> poses = read_kitti_poses(file);
  const LinePlace place = find_lines(file, poses.size(), "poses", images);
  Trajectory truth;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    truth.push_back({frames[i].timestamp, poses[place.line(images, i)]});
  }
  return truth;
}

// Names that are times with a varying number of decimals (12.5, 12.25) do not stand in the order of time.
void sort_by_time(Recording& recording) {
  const auto is_earlier = [](const auto& a, const auto& b) { return a.timestamp < b.timestamp; };
  std::stable_sort(recording.frames.begin(), recording.frames.end(), is_earlier);
  std::stable_sort(recording.ground_truth.begin(), recording.ground_truth.end(), is_earlier);
}

// Some files of raw cameras, as OpenCV's, do not say how large the images are that they were made with.
void take_size(const fs::path& first_image, CameraFile& file) {
  if (file.rectified || file.left.width > 0) return;
  const nn::ImageInfo image = nn::read_image_info(first_image);
  file.left.width = file.right.width = image.width;
  file.left.height = file.right.height = image.height;
  file.notes.push_back("the calibration does not say the size of its images: that of the first one is taken");
}

}  // namespace

bool looks_like_image_folder(const fs::path& path) { return is_present(path / "calibration.yaml"); }

std::unique_ptr<StereoDataset> open_image_folder(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  const fs::path folder = fs::canonical(path);
  CameraFile file = read_camera_file(folder / "calibration.yaml");
  const bool rgbd = file.sensor == Sensor::rgbd;

  Recording recording;
  recording.name = folder.filename().string();
  recording.place = folder.string();
  recording.sensor = file.sensor;
  recording.depth_factor = file.depth_factor;
  recording.colour =
      colour_of(options.cameras, file.colour.value_or(rgbd) ? nn::ImageColour::bgr : nn::ImageColour::grey);
  if (!is_present(folder / (rgbd ? "rgb" : "left")) && !is_present(folder / (rgbd ? "depth" : "right"))) {
    throw InputError(folder.string(), rgbd ? "rgb/ and depth/ with images" : "left/ and right/ with images",
                     "neither");
  }
  const ImagePairs images =
      pair_images(folder / (rgbd ? "rgb" : "left"), folder / (rgbd ? "depth" : "right"));
  if (!images.pairs.empty()) take_size(images.first[images.pairs.front().first].path, file);
  recording.notes = file.notes;
  recording.notes.insert(recording.notes.end(), images.notes.begin(), images.notes.end());
  const RecordedCamera camera = make_camera(file);
  recording.camera = camera.camera;
  recording.left = camera.left;
  recording.right = camera.right;
  for (const ImagePair& pair : images.pairs) {
    recording.frames.push_back(
        {static_cast<int>(pair.first), 0.0, images.first[pair.first].path, images.second[pair.second].path});
  }
  if (images.alone > 0)
    recording.notes.push_back(
        fmt::format("{} images without a partner of the same name are left out", images.alone));
  set_times(folder, images, options.frame_rate, file.frame_rate, recording);
  recording.ground_truth = find_ground_truth(folder, images, recording.frames, &recording.notes);
  sort_by_time(recording);
  const SE3 T_left_rectified{camera.R_rectified_left.transpose(), Eigen::Vector3d::Zero()};
  for (TimedPose& pose : recording.ground_truth) pose.T_wc = pose.T_wc * T_left_rectified;
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
