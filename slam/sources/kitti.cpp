#include "slam/sources/kitti.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/number_file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/kitti_calibration.h"
#include "slam/sources/recorded_sequence.h"
#include "slam/sources/time_list.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// The number that an image is named by; -1 where it is none.
int number_of(const fs::path& image) {
  const std::string stem = image.stem().string();
  int number = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
  return error == std::errc() && end == stem.data() + stem.size() ? number : -1;
}

// Checks that the two lists hold the same frames, numbered without gaps, and names the first that breaks the
// rule. Returns the number of the first frame.
int require_pairs(const std::vector<fs::path>& left, const std::vector<fs::path>& right) {
  const int first = std::max(0, number_of(left.front()));
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    const int number = first + static_cast<int>(i);
    const std::string expected = fmt::format("{:06}", number);
    const bool in_left = i < left.size() && number_of(left[i]) == number;
    const bool in_right = i < right.size() && number_of(right[i]) == number;
    if (in_left && in_right) continue;
    const std::vector<fs::path>& lacking = in_left ? right : left;
    const fs::path folder = lacking.front().parent_path();
    if (in_left != in_right) {
      throw InputError(
          folder.string(),
          fmt::format("frame {} as in {}", expected, (in_left ? left : right).front().parent_path().string()),
          fmt::format("no such image ({} left, {} right images)", left.size(), right.size()));
    }
    throw InputError(folder.string(), fmt::format("frame {}: numbers without gaps", expected),
                     i < lacking.size() ? lacking[i].filename().string() : "nothing");
  }
  return first;
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

// The lines of a file that belong to `frames` frames from number `first` on, of `lines` in it: line i to
// frame i; or, where the file is a piece as the images are, all in turn. The first of them. Throws InputError
// where there are too few.
std::size_t first_line(const fs::path& path, const char* what, std::size_t lines, std::size_t first,
                       std::size_t frames, std::vector<std::string>& notes) {
  if (lines >= first + frames) return first;
  if (lines == frames) {
    notes.push_back(fmt::format("{}: {} {}, taken for frames {} to {}", path.string(), lines, what, first,
                                first + frames - 1));
    return 0;
  }
  throw InputError(path.string(),
                   first == 0 ? fmt::format("{} of {}", what, counted(frames, "frame"))
                              : fmt::format("{} of {}, or of frames 0 to {}", what, counted(frames, "frame"),
                                            first + frames - 1),
                   fmt::format("{}", lines));
}

std::vector<double> read_times(const fs::path& path, std::size_t first, std::size_t frames,
                               std::optional<double> rate, std::vector<std::string>& notes) {
  std::vector<double> times;
  if (!is_present(path)) {
    if (!rate)
      throw InputError(path.string(), "a time in seconds in each line, or --rate HZ", "no such file");
    if (!(*rate > 0.0)) throw UsageError(fmt::format("frame rate {:g}: expected more than 0 Hz", *rate));
    for (std::size_t i = first; i < first + frames; ++i) times.push_back(static_cast<double>(i) / *rate);
    return times;
  }
  note_unused_rate(rate, path, notes);
  times = read_time_list(path, notes);
  const std::size_t begin = first_line(path, "times", times.size(), first, frames, notes);
  times.erase(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(begin));
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
                             std::size_t first, std::size_t frames, std::vector<std::string>& notes) {
  const auto file = std::find_if(sequence.pose_files.begin(), sequence.pose_files.end(), is_present);
  if (file == sequence.pose_files.end()) return {};
  const std::vector<SE3> poses = read_kitti_poses(*file);
  const std::size_t begin = first_line(*file, "poses", poses.size(), first, frames, notes);
  Trajectory truth;
  for (std::size_t i = 0; i < frames; ++i) truth.push_back({times[i], poses[begin + i]});
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
  const std::vector<fs::path> left = list_images(folder / (colour ? "image_2" : "image_0"), recording.notes);
  const std::vector<fs::path> right = list_images(folder / (colour ? "image_3" : "image_1"), recording.notes);
  const int first = require_pairs(left, right);
  const auto offset = static_cast<std::size_t>(first);
  options.frames.size(static_cast<int>(left.size()), recording.place);
  recording.camera = read_kitti_calibration(folder / "calib.txt", colour ? 2 : 0, colour ? 3 : 1);
  const std::vector<double> times =
      read_times(folder / "times.txt", offset, left.size(), options.frame_rate, recording.notes);
  recording.ground_truth = read_ground_truth(sequence, times, offset, left.size(), recording.notes);
  for (std::size_t i = 0; i < left.size(); ++i) {
    recording.frames.push_back({first + static_cast<int>(i), times[i], left[i], right[i]});
  }
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
