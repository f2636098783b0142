#include "slam/sources/paired_folders.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_pairs.h"
#include "slam/sources/named_times.h"
#include "slam/sources/recorded_sequence.h"

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
  std::string expected = fmt::format("{} of {}", what, counted(images.first.size(), "frame"));
  if (images.alone > 0) expected += fmt::format(" (or of the {} with a partner)", images.pairs.size());
  throw InputError(file.string(), expected, fmt::format("{}", lines));
}

std::vector<double> times_of_pairs(const PairedFolders& folders, const ImagePairs& images, Notes& notes) {
  const LinePlace place = find_lines(folders.times.file, folders.times.lines.size(), "times", images);
  if (images.alone > 0)
    notes.push_back(fmt::format("{}: one line for every {}", folders.times.file.string(), place.of));
  std::vector<double> times;
  for (std::size_t pair = 0; pair < images.pairs.size(); ++pair)
    times.push_back(folders.times.lines[place.line(images, pair)]);
  return times;
}

// `asked_rate`: --rate.
void set_times(const PairedFolders& folders, const ImagePairs& images, std::optional<double> asked_rate,
               Recording& recording) {
  const bool has_file = !folders.times.file.empty();
  Notes of_names;
  std::vector<double> times =
      has_file ? times_of_pairs(folders, images, recording.notes) : times_in_names(images, of_names);
  recording.notes.insert(recording.notes.end(), of_names.begin(), of_names.end());
  if (times.empty()) {
    std::optional<double> rate = folders.camera.frame_rate ? folders.camera.frame_rate : folders.rate;
    if (asked_rate) rate = asked_rate;
    if (!rate) {
      throw InputError(
          folders.place.string(),
          "times.txt, images named by their times, or 'rate: HZ' in calibration.yaml (or --rate HZ)",
          of_names.empty() ? "none of them" : of_names.back());
    }
    if (!(*rate > 0.0)) throw UsageError(fmt::format("frame rate {:g}: expected more than 0 Hz", *rate));
    times = places_in_names(images);
    for (double& time : times) time /= *rate;
  } else {
    note_unused_rate(asked_rate, has_file ? folders.times.file : folders.first, recording.notes);
  }
  for (std::size_t i = 0; i < times.size(); ++i) recording.frames[i].timestamp = times[i];
}

Trajectory truth_of_pairs(const PairedFolders& folders, const ImagePairs& images,
                          const std::vector<RecordedFrame>& frames) {
  if (!folders.numbered_truth.empty()) {
    Trajectory truth;
    std::map<double, SE3> by_number;
    for (const TimedPose& pose : folders.numbered_truth) by_number[pose.timestamp] = pose.T_wc;
    for (const RecordedFrame& frame : frames) {
      const auto at = by_number.find(number_in_name(frame.left.file.stem().string()).value_or(-1.0));
      if (at != by_number.end()) truth.push_back({frame.timestamp, at->second});
    }
    return truth;
  }
  if (folders.poses.file.empty()) return folders.truth;
  const LinePlace place = find_lines(folders.poses.file, folders.poses.lines.size(), "poses", images);
  Trajectory truth;
  for (std::size_t i = 0; i < frames.size(); ++i)
    truth.push_back({frames[i].timestamp, folders.poses.lines[place.line(images, i)]});
  return truth;
}

void note_other_size(const fs::path& image, PairedFolders& folders) {
  if (!folders.made_for) return;
  const Size expected = *folders.made_for;
  const nn::ImageInfo found = nn::read_image_info(image);
  if (Size{found.width, found.height} == expected) return;
  folders.notes.push_back(fmt::format(
      "{}: its camera is that of images of {} x {} pixels, {} has {} x {}: the trajectory is wrong if "
      "another "
      "camera took these (put them as a folder of your own images, with its calibration: docs/datasets.md)",
      folders.name, expected.width, expected.height, image.string(), found.width, found.height));
}

// Names that are times with a varying number of decimals (12.5, 12.25) do not stand in the order of time.
void sort_by_time(Recording& recording) {
  const auto is_earlier = [](const auto& a, const auto& b) { return a.timestamp < b.timestamp; };
  std::stable_sort(recording.frames.begin(), recording.frames.end(), is_earlier);
  std::stable_sort(recording.ground_truth.begin(), recording.ground_truth.end(), is_earlier);
}

}  // namespace

std::unique_ptr<StereoDataset> open_paired_folders(PairedFolders folders, const DatasetOptions& options) {
  const bool rgbd = folders.camera.sensor == Sensor::rgbd;
  const ImagePairs images = pair_images(folders.first, folders.second);
  if (lacks_size(folders.camera)) {
    const nn::ImageInfo first = nn::read_image_info(images.first[images.pairs.front().first].path);
    take_size({first.width / (folders.side_by_side ? 2 : 1), first.height}, folders.camera);
  }
  note_other_size(images.first[images.pairs.front().first].path, folders);
  const RecordedCamera camera = folders.made ? *folders.made : make_camera(folders.camera);

  Recording recording;
  recording.name = folders.name;
  recording.place = folders.place.string();
  recording.sensor = folders.camera.sensor;
  recording.side_by_side = folders.side_by_side;
  recording.camera = camera.camera;
  recording.mountings = camera.mountings;
  recording.left = camera.left;
  recording.right = camera.right;
  recording.images =
      folders.mosaic ? mosaic_images(*folders.mosaic) : file_images(folders.camera.depth_factor);
  recording.colour = colour_of(
      options.cameras, folders.camera.colour.value_or(rgbd) ? nn::ImageColour::bgr : nn::ImageColour::grey);
  for (const Notes& notes : {folders.notes, folders.camera.notes, images.notes})
    recording.notes.insert(recording.notes.end(), notes.begin(), notes.end());
  for (const ImagePair& pair : images.pairs) {
    recording.frames.push_back(
        {static_cast<int>(pair.first), 0.0, images.first[pair.first].path, images.second[pair.second].path});
  }
  if (images.alone > 0)
    recording.notes.push_back(
        fmt::format("left out: {} without a partner of the same name", counted(images.alone, "image")));
  set_times(folders, images, options.frame_rate, recording);
  recording.ground_truth = truth_of_pairs(folders, images, recording.frames);
  sort_by_time(recording);
  const SE3 T_left_rectified{camera.R_rectified_left.transpose(), Eigen::Vector3d::Zero()};
  for (TimedPose& pose : recording.ground_truth) pose.T_wc = pose.T_wc * T_left_rectified;
  return open_recording(std::move(recording), options);
}

}  // namespace penumbra::slam
