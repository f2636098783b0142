#include "slam/datasets/kitti.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "nn/io/number_file.h"
#include "slam/datasets/folder_listing.h"
#include "slam/datasets/kitti_calibration.h"
#include "slam/datasets/recorded_sequence.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// Checks that the two lists hold the same frames, 0, 1, 2, ..., and names the first that breaks the rule.
void require_pairs(const std::vector<fs::path>& left, const std::vector<fs::path>& right) {
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    const std::string expected = fmt::format("{:06}", i);
    const bool in_left = i < left.size() && left[i].stem() == expected;
    const bool in_right = i < right.size() && right[i].stem() == expected;
    if (in_left && in_right) continue;
    const std::vector<fs::path>& lacking = in_left ? right : left;
    const fs::path folder = lacking.front().parent_path();
    if (in_left != in_right) {
      throw InputError(
          folder.string(),
          fmt::format("frame {} as in {}", expected, (in_left ? left : right).front().parent_path().string()),
          fmt::format("no such image ({} left, {} right images)", left.size(), right.size()));
    }
    throw InputError(folder.string(), fmt::format("frame {}: numbers from 000000 without gaps", expected),
                     i < lacking.size() ? lacking[i].filename().string() : "nothing");
  }
}

struct SequenceFolder {
  std::string name;
  fs::path folder;
  std::vector<fs::path> pose_files;  // where ground truth may be, best first
};

SequenceFolder find_in_root(const fs::path& root, const std::string& sequence) {
  const fs::path parent = root / "sequences";
  const std::vector<std::string> names = kitti_sequences(root);
  if (names.empty()) throw InputError(parent.string(), "folders of sequences", "none");
  const std::string found = fmt::format("{}", fmt::join(names, ", "));
  if (sequence.empty() && names.size() > 1) {
    throw UsageError(fmt::format("{}: several sequences, choose one: {}", parent.string(), found));
  }
  if (!sequence.empty() && std::find(names.begin(), names.end(), sequence) == names.end()) {
    throw InputError(parent.string(), fmt::format("sequence {}", sequence), fmt::format("only {}", found));
  }
  const std::string name = sequence.empty() ? names.front() : sequence;
  return {name, parent / name, {root / "poses" / (name + ".txt"), parent / name / "poses.txt"}};
}

SequenceFolder find_sequence(const fs::path& path, const std::string& sequence) {
  if (is_folder(path / "sequences")) return find_in_root(path, sequence);
  const fs::path folder = fs::canonical(path);
  const std::string name = folder.filename().string();
  if (!sequence.empty() && sequence != name) {
    throw UsageError(
        fmt::format("{}: is itself a sequence, so sequence {} cannot be in it", path.string(), sequence));
  }
  return {name, path, {path / "poses.txt", folder.parent_path().parent_path() / "poses" / (name + ".txt")}};
}

bool wants_colour(const fs::path& folder, DatasetCameras cameras) {
  if (cameras != DatasetCameras::automatic) return cameras == DatasetCameras::colour;
  const bool has_grey = is_folder(folder / "image_0") || is_folder(folder / "image_1");
  const bool has_colour = is_folder(folder / "image_2") || is_folder(folder / "image_3");
  if (!has_grey && !has_colour) {
    throw InputError(folder.string(), "image_0/ and image_1/ (grey) or image_2/ and image_3/ (colour)",
                     "neither");
  }
  return !has_grey;
}

std::vector<double> read_times(const fs::path& path, std::size_t frames, std::optional<double> rate) {
  std::vector<double> times;
  if (rate && !is_present(path)) {
    if (!(*rate > 0.0)) throw UsageError(fmt::format("frame rate {:g}: expected more than 0 Hz", *rate));
    for (std::size_t i = 0; i < frames; ++i) times.push_back(static_cast<double>(i) / *rate);
    return times;
  }
  for (const nn::NumberLine& record : nn::read_number_file(path, 1, "a time in seconds")) {
    const double time = record.values.front();
    if (!times.empty() && time <= times.back()) {
      throw InputError(fmt::format("{}:{}", path.string(), record.line),
                       fmt::format("a time after {:g} s", times.back()), fmt::format("{:g} s", time));
    }
    times.push_back(time);
  }
  if (times.size() < frames) {
    throw InputError(path.string(), fmt::format("times of {} frames", frames),
                     fmt::format("{}", times.size()));
  }
  return times;
}

// What the recording is called: the line in name.txt, where there is one.
std::string read_name(const SequenceFolder& sequence) {
  constexpr std::size_t kLongest = 100;  // bytes
  const fs::path path = sequence.folder / "name.txt";
  if (!is_present(path)) return "KITTI odometry " + sequence.name;
  std::string name = nn::read_text_file(path, "the name of the recording");
  if (!name.empty() && name.back() == '\n') name.pop_back();
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (name.empty() || name.size() > kLongest || std::any_of(name.begin(), name.end(), is_control)) {
    throw InputError(path.string(), fmt::format("one line of text, {} bytes at most", kLongest),
                     fmt::format("{} bytes", name.size()));
  }
  return name;
}

Trajectory read_ground_truth(const SequenceFolder& sequence, const std::vector<double>& times,
                             std::size_t frames) {
  const auto file = std::find_if(sequence.pose_files.begin(), sequence.pose_files.end(), is_present);
  if (file == sequence.pose_files.end()) return {};
  const std::vector<SE3> poses = read_kitti_poses(*file);
  if (poses.size() < frames) {
    throw InputError(file->string(), fmt::format("poses of {} frames", frames),
                     fmt::format("{}", poses.size()));
  }
  Trajectory truth;
  for (std::size_t i = 0; i < frames; ++i) truth.push_back({times[i], poses[i]});
  return truth;
}

}  // namespace

std::vector<std::string> kitti_sequences(const fs::path& path) {
  std::vector<std::string> names;
  if (!is_folder(path / "sequences")) return names;
  for (const fs::path& entry : list_folder(path / "sequences")) {
    if (is_folder(entry)) names.push_back(entry.filename().string());
  }
  return names;
}

bool looks_like_kitti(const fs::path& path) {
  return is_folder(path / "sequences") || is_present(path / "calib.txt") || is_folder(path / "image_0") ||
         is_folder(path / "image_2");
}

std::unique_ptr<StereoDataset> open_kitti(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  const SequenceFolder sequence = find_sequence(path, options.sequence);
  const fs::path& folder = sequence.folder;
  if (is_present(folder)) require_dataset_folder(folder);
  const bool colour = wants_colour(folder, options.cameras);
  Recording recording;
  recording.name = read_name(sequence);
  recording.place = folder.string();
  recording.colour = colour ? nn::ImageColour::bgr : nn::ImageColour::grey;
  const std::vector<fs::path> left = list_images(folder / (colour ? "image_2" : "image_0"));
  const std::vector<fs::path> right = list_images(folder / (colour ? "image_3" : "image_1"));
  require_pairs(left, right);
  options.frames.size(static_cast<int>(left.size()), recording.place);
  recording.camera = read_kitti_calibration(folder / "calib.txt", colour ? 2 : 0, colour ? 3 : 1);
  const std::vector<double> times = read_times(folder / "times.txt", left.size(), options.frame_rate);
  recording.ground_truth = read_ground_truth(sequence, times, left.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    recording.frames.push_back({static_cast<int>(i), times[i], left[i], right[i]});
  }
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
