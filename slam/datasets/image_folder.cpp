#include "slam/datasets/image_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <string>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/number_file.h"
#include "slam/datasets/camera_file.h"
#include "slam/datasets/folder_listing.h"
#include "slam/datasets/recorded_sequence.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNanosecondDigits = 15;

// Seconds, where the name of an image is a time.
std::optional<double> time_in_name(const std::string& stem) {
  const bool digits_only = stem.find_first_not_of("0123456789") == std::string::npos;
  const bool seconds = !digits_only && stem.find_first_not_of("0123456789.") == std::string::npos;
  if (!seconds && !(digits_only && stem.size() >= kNanosecondDigits)) return std::nullopt;
  double value = 0.0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), value);
  if (error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  return seconds ? value : 1e-9 * value;
}

void pair_images(const fs::path& first, const fs::path& second, Recording& recording) {
  const std::vector<fs::path> left = list_images(first), right = list_images(second);
  std::size_t r = 0, alone = 0;
  for (const fs::path& image : left) {
    const std::string stem = image.stem().string();
    while (r < right.size() && right[r].stem().string() < stem) {
      ++r;
      ++alone;
    }
    if (r < right.size() && right[r].stem().string() == stem) {
      recording.frames.push_back({static_cast<int>(recording.frames.size()), 0.0, image, right[r++]});
    } else {
      ++alone;
    }
  }
  alone += right.size() - r;
  if (recording.frames.empty()) {
    throw InputError(second.string(), fmt::format("images of the same names as in {}", first.string()),
                     fmt::format("none, such as '{}'", printable(right.front().filename().string(), 40)));
  }
  if (alone > 0)
    recording.notes.push_back(
        fmt::format("{} images without a partner of the same name are left out", alone));
}

void set_times(const fs::path& folder, std::optional<double> rate, std::vector<RecordedFrame>& frames) {
  const fs::path file = folder / "times.txt";
  if (is_present(file)) {
    const std::vector<nn::NumberLine> lines = nn::read_number_file(file, 1, "a time in seconds");
    if (lines.size() != frames.size()) {
      throw InputError(file.string(), fmt::format("times of {} frames", frames.size()),
                       fmt::format("{}", lines.size()));
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
      frames[i].timestamp = lines[i].values.front();
      if (i > 0 && !(frames[i].timestamp > frames[i - 1].timestamp)) {
        throw InputError(fmt::format("{}:{}", file.string(), lines[i].line),
                         fmt::format("a time after {:g} s", frames[i - 1].timestamp),
                         fmt::format("{:g} s", frames[i].timestamp));
      }
    }
    return;
  }
  const bool named = std::all_of(frames.begin(), frames.end(), [](const RecordedFrame& f) {
    return time_in_name(f.left.stem().string()).has_value();
  });
  if (!named && !rate) {
    throw InputError(folder.string(),
                     "times.txt, images named by their times, or 'rate: HZ' in calibration.yaml",
                     "none of them");
  }
  if (!named && !(*rate > 0.0))
    throw UsageError(fmt::format("frame rate {:g}: expected more than 0 Hz", *rate));
  for (RecordedFrame& f : frames) {
    f.timestamp = named ? *time_in_name(f.left.stem().string()) : static_cast<double>(f.index) / *rate;
  }
}

Trajectory find_ground_truth(const fs::path& folder, const std::vector<RecordedFrame>& frames) {
  if (is_present(folder / "groundtruth.txt")) return read_tum_trajectory(folder / "groundtruth.txt");
  const fs::path file = folder / "poses.txt";
  if (!is_present(file)) return {};
  const std::vector<SE3> poses = read_kitti_poses(file);
  if (poses.size() != frames.size()) {
    throw InputError(file.string(), fmt::format("poses of {} frames", frames.size()),
                     fmt::format("{}", poses.size()));
  }
  Trajectory truth;
  for (std::size_t i = 0; i < frames.size(); ++i) truth.push_back({frames[i].timestamp, poses[i]});
  return truth;
}

}  // namespace

bool looks_like_image_folder(const fs::path& path) { return is_present(path / "calibration.yaml"); }

std::unique_ptr<StereoDataset> open_image_folder(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  const fs::path folder = fs::canonical(path);
  const CameraFile file = read_camera_file(folder / "calibration.yaml");
  const RecordedCamera camera = make_camera(file);
  const bool rgbd = file.sensor == Sensor::rgbd;

  Recording recording;
  recording.name = folder.filename().string();
  recording.place = folder.string();
  recording.sensor = file.sensor;
  recording.camera = camera.camera;
  recording.left = camera.left;
  recording.right = camera.right;
  recording.depth_factor = file.depth_factor;
  recording.colour =
      colour_of(options.cameras, file.colour.value_or(rgbd) ? nn::ImageColour::bgr : nn::ImageColour::grey);
  pair_images(folder / (rgbd ? "rgb" : "left"), folder / (rgbd ? "depth" : "right"), recording);
  set_times(folder, options.frame_rate ? options.frame_rate : file.frame_rate, recording.frames);
  recording.ground_truth = find_ground_truth(folder, recording.frames);
  const SE3 T_left_rectified{camera.R_rectified_left.transpose(), Eigen::Vector3d::Zero()};
  for (TimedPose& pose : recording.ground_truth) pose.T_wc = pose.T_wc * T_left_rectified;
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
