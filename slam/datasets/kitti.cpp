#include "slam/datasets/kitti.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/io/image_file.h"
#include "nn/io/number_file.h"
#include "slam/datasets/kitti_calibration.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_present(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

// Entries of a folder, sorted by name. Throws InputError where it cannot be listed.
std::vector<fs::path> list_folder(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    entries.push_back(entry->path());
  }
  if (error) throw InputError(folder.string(), "a folder", error.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

// The images of a folder, sorted by name; other files are left out.
std::vector<fs::path> list_images(const fs::path& folder) {
  if (!is_folder(folder)) {
    throw InputError(folder.string(), "a folder of images", is_present(folder) ? "a file" : "nothing");
  }
  std::vector<fs::path> images;
  for (const fs::path& entry : list_folder(folder)) {
    const std::string ending = entry.extension().string();
    if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") images.push_back(entry);
  }
  if (images.empty()) throw InputError(folder.string(), "images (.png or .jpg)", "none");
  return images;
}

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
  std::vector<std::string> names;
  for (const fs::path& entry : list_folder(parent)) {
    if (is_folder(entry)) names.push_back(entry.filename().string());
  }
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

class KittiDataset final : public StereoDataset {
 public:
  KittiDataset(const fs::path& path, const DatasetOptions& options) {
    const SequenceFolder sequence = find_sequence(path, options.sequence);
    const fs::path& folder = sequence.folder;
    name_ = "KITTI odometry " + sequence.name;
    if (is_present(folder)) require_dataset_folder(folder);
    const bool colour = wants_colour(folder, options.cameras);
    colour_ = colour ? nn::ImageColour::bgr : nn::ImageColour::grey;
    left_ = list_images(folder / (colour ? "image_2" : "image_0"));
    right_ = list_images(folder / (colour ? "image_3" : "image_1"));
    require_pairs(left_, right_);
    first_ = options.frames.begin;
    size_ = options.frames.size(static_cast<int>(left_.size()), folder.string());
    camera_ = read_kitti_calibration(folder / "calib.txt", colour ? 2 : 0, colour ? 3 : 1);
    times_ = read_times(folder / "times.txt", left_.size(), options.frame_rate);
    read_ground_truth(sequence.pose_files);

    const cv::Mat left = nn::read_image(left_[index(0)], colour_);
    camera_.width = left.cols;
    camera_.height = left.rows;
    read(right_[index(0)]);
  }

  std::string name() const override { return name_; }
  const StereoCamera& camera() const override { return camera_; }
  int size() const override { return size_; }
  double timestamp(int i) const override { return times_[index(i)]; }
  const std::optional<Trajectory>& ground_truth() const override { return ground_truth_; }

  StereoImages load(int i) const override {
    return {first_ + i, timestamp(i), read(left_[index(i)]), read(right_[index(i)])};
  }

 private:
  std::size_t index(int i) const { return static_cast<std::size_t>(first_ + i); }

  cv::Mat read(const fs::path& path) const {
    cv::Mat image = nn::read_image(path, colour_);
    if (image.cols != camera_.width || image.rows != camera_.height) {
      throw InputError(
          path.string(),
          fmt::format("{} x {} pixels as in the first left image", camera_.width, camera_.height),
          fmt::format("{} x {}", image.cols, image.rows));
    }
    return image;
  }

  void read_ground_truth(const std::vector<fs::path>& pose_files) {
    const auto file = std::find_if(pose_files.begin(), pose_files.end(), is_present);
    if (file == pose_files.end()) return;
    const std::vector<SE3> poses = read_kitti_poses(*file);
    if (poses.size() < left_.size()) {
      throw InputError(file->string(), fmt::format("poses of {} frames", left_.size()),
                       fmt::format("{}", poses.size()));
    }
    ground_truth_.emplace();
    for (int i = 0; i < size_; ++i) ground_truth_->push_back({timestamp(i), poses[index(i)]});
  }

  std::string name_;
  nn::ImageColour colour_ = nn::ImageColour::grey;
  std::vector<fs::path> left_, right_;  // all frames of the sequence
  int first_ = 0, size_ = 0;            // the part that is read
  StereoCamera camera_;
  std::vector<double> times_;  // all frames of the sequence
  std::optional<Trajectory> ground_truth_;
};

}  // namespace

bool looks_like_kitti(const fs::path& path) {
  return is_folder(path / "sequences") || is_present(path / "calib.txt") || is_folder(path / "image_0") ||
         is_folder(path / "image_2");
}

void require_dataset_folder(const fs::path& path) {
  constexpr const char* kExpected = "the folder of a dataset";
  if (!is_present(path)) throw InputError(path.string(), kExpected, "nothing");
  if (!is_folder(path)) throw InputError(path.string(), kExpected, "a file");
  if (list_folder(path).empty()) throw InputError(path.string(), kExpected, "an empty folder");
}

std::unique_ptr<StereoDataset> open_kitti(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  return std::make_unique<KittiDataset>(path, options);
}

}  // namespace penumbra::slam
