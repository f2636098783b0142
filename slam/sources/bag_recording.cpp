#include "slam/sources/bag_recording.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/text.h"
#include "slam/geometry/time_unit.h"
#include "slam/sources/bag/bag_index.h"
#include "slam/sources/bag_images.h"
#include "slam/sources/bag_topics.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/camera_info.h"
#include "slam/sources/fixed_frames.h"
#include "slam/sources/image_list.h"
#include "slam/sources/recorded_sequence.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

constexpr double kSameInstant = 0.001;  // seconds between two cameras that are triggered together
constexpr double kSameDepth = 0.02;     // between colour and depth, as of TUM's cameras

std::string described(const BagIndex& index) {
  std::string text;
  constexpr std::size_t kShown = 8;
  for (std::size_t i = 0; i < std::min(kShown, index.images.size()); ++i) {
    const ImageTopic& t = index.images[i];
    text += fmt::format("{}{} ({}, {})", i == 0 ? "" : ", ", printable(t.name, 100), printable(t.format, 40),
                        counted(t.images.size(), "image"));
  }
  if (index.images.size() > kShown) text += fmt::format(" and {} more", index.images.size() - kShown);
  return text.empty() ? "no topic with images" : text;
}

// T_frame_left of every frame in which the left camera, or that beside the depth, stands still.
std::map<std::string, SE3> frames_of(const BagIndex& index, const ChosenTopics& topics) {
  std::string frame = topics.left->frame;
  if (frame.empty() && topics.left_camera != nullptr) frame = topics.left_camera->info.frame;
  return frame.empty() ? std::map<std::string, SE3>() : fixed_frames(index.fixed, frame);
}

// What was odd about a topic's times and messages.
void note_topic(const ImageTopic& topic, std::vector<std::string>& notes) {
  const std::string name = printable(topic.name, 100);
  const std::size_t all = topic.images.size();
  if (topic.without_stamp > 0) {
    notes.push_back(fmt::format("{}: {} of {} without a time; the time of recording is taken", name,
                                topic.without_stamp, counted(all, "header")));
  }
  if (topic.backwards > 0) {
    notes.push_back(
        fmt::format("{}: times go back in {} of the file; images are taken in the order of their times", name,
                    counted(topic.backwards, "place")));
  }
  if (topic.damaged > 0)
    notes.push_back(
        fmt::format("{}: left out: {} without a whole image", name, counted(topic.damaged, "message")));
}

// Times and places of a topic's images, of several with one time the first.
struct TimedImages {
  ImageList list;
  std::vector<std::size_t> places;

  explicit TimedImages(const ImageTopic& topic) {
    for (std::size_t i = 0; i < topic.images.size(); ++i) {
      if (i > 0 && topic.images[i].time == topic.images[i - 1].time) continue;
      const FileTime time{static_cast<double>(topic.images[i].time), topic.images[i].time};
      list.images.push_back({to_seconds(time, TimeUnit::nanoseconds), std::string()});
      places.push_back(i);
    }
    const std::size_t repeated = topic.images.size() - places.size();
    if (repeated > 0)
      list.notes.push_back(fmt::format("{}: left out: {} with the time of the one before",
                                       printable(topic.name, 100), counted(repeated, "image")));
  }
};

RecordedCamera camera_of(const BagIndex& index, const ChosenTopics& topics, const DatasetOptions& options,
                         const std::string& place, std::vector<std::string>& notes) {
  if (!options.camera.empty()) {
    CameraFile file = read_camera_file(options.camera);
    if (file.sensor != topics.sensor) {
      throw InputError(options.camera.string(),
                       topics.sensor == Sensor::stereo ? "a stereo camera" : "an RGB-D camera",
                       topics.sensor == Sensor::stereo ? "an RGB-D camera" : "a stereo camera");
    }
    const Size& size = topics.left->size;
    if (lacks_size(file) && size.width > 0) take_size(size, file);
    notes.insert(notes.end(), file.notes.begin(), file.notes.end());
    return make_camera(file);
  }
  const auto said = [&](const CameraTopic* camera, const ImageTopic& image) -> SaidCamera {
    if (camera == nullptr) {
      throw InputError(
          place,
          fmt::format(
              "a sensor_msgs/CameraInfo beside {} (--left-info-topic and --right-info-topic name it), or "
              "the camera by --camera FILE (docs/datasets.md)",
              printable(image.name, 100)),
          "none");
    }
    return {camera->info, fmt::format("{}: {}", place, printable(camera->name, 100))};
  };
  const SaidCamera left = said(topics.left_camera, *topics.left);
  if (topics.sensor == Sensor::rgbd) return rgbd_camera(left, says_rectified(topics.left->name));
  const SaidCamera right = said(topics.second_camera, *topics.second);
  const bool are_rectified = says_rectified(topics.left->name) && says_rectified(topics.second->name);
  if (!has_baseline(left.info, right.info)) {
    if (const auto T_right_left = fixed_transform(index.fixed, right.info.frame, left.info.frame)) {
      notes.push_back(
          fmt::format("the cameras do not say how far they are apart; the fixed frames of tf do: {:.4g} m",
                      T_right_left->translation.norm()));
      return stereo_camera_at(left, right, *T_right_left, are_rectified);
    }
  }
  return stereo_camera(left, right, are_rectified);
}

void note_camera(const ChosenTopics& topics, const DatasetOptions& options, std::vector<std::string>& notes) {
  if (!topics.is_registered)
    notes.push_back(
        "the depth does not look as if it were registered to the image; it is taken as asked for");
  if (!options.camera.empty()) return;
  for (const CameraTopic* camera : {topics.left_camera, topics.second_camera}) {
    if (camera != nullptr && camera->changes > 0)
      notes.push_back(fmt::format("{}: the first is taken, and {} that said something else left out",
                                  printable(camera->name, 100), counted(camera->changes, "message")));
  }
}

}  // namespace

std::unique_ptr<StereoDataset> open_bag_recording(const fs::path& path, const DatasetOptions& options) {
  std::unique_ptr<MessageSource> source = open_bag(path);
  const BagIndex index = index_bag(*source);
  const std::string place = printable(path.string(), 400);
  std::string reason;
  const std::optional<ChosenTopics> topics = choose_topics(index, options, place, reason);
  if (!topics) {
    std::string found = described(index);
    if (!reason.empty()) found += "; " + reason;
    for (const std::string& note : source->notes()) found += "; " + note;
    throw InputError(
        place,
        "images of a left and a right camera (/left/..., /right/...), or depth that is registered to an "
        "image; --left-topic with --right-topic or --depth-topic choose",
        found);
  }
  Recording recording;
  RecordedCamera camera = camera_of(index, *topics, options, place, recording.notes);
  for (const auto& [frame, T_frame_left] : frames_of(index, *topics)) camera.stands({frame, T_frame_left});
  const bool rgbd = topics->sensor == Sensor::rgbd;

  recording.name = fmt::format("{} {}", source->kind(), path.filename().string());
  recording.place = place;
  recording.sensor = topics->sensor;
  recording.camera = camera.camera;
  recording.mountings = std::move(camera.mountings);
  recording.left = camera.left;
  recording.right = camera.right;
  recording.colour = colour_of(options.cameras, rgbd ? nn::ImageColour::bgr : nn::ImageColour::grey);
  recording.notes.insert(recording.notes.end(), source->notes().begin(), source->notes().end());
  recording.notes.push_back(topics->text());
  note_camera(*topics, options, recording.notes);
  note_unused_rate(options.frame_rate, path, recording.notes);
  for (const ImageTopic* topic : {topics->left, topics->second}) note_topic(*topic, recording.notes);

  const TimedImages first(*topics->left), second(*topics->second);
  for (std::string& note : joined_notes(first.list, second.list)) recording.notes.push_back(std::move(note));
  const PairingTexts texts{place,
                           fmt::format("images of {} and {} within {{:g}} s of each other",
                                       rgbd ? "the image topic" : "left", rgbd ? "of depth" : "right"),
                           rgbd ? "images" : "left", rgbd ? "depth images" : "right images"};
  const double within = options.pair_within.value_or(rgbd ? kSameDepth : kSameInstant);
  auto images = std::make_shared<BagImages>(std::move(source), place);
  for (const auto& [a, b] : pair_by_time(first.list, second.list, within, texts, recording.notes)) {
    const double time = first.list.images[a].timestamp;
    RecordedFrame frame;
    frame.index = static_cast<int>(recording.frames.size());
    frame.timestamp = time;
    frame.left = images->add(*topics->left, first.places[a]);
    frame.second = images->add(*topics->second, second.places[b]);
    if (rgbd) frame.depth_delay = second.list.images[b].timestamp - time;
    recording.frames.push_back(std::move(frame));
  }
  recording.images = std::move(images);
  return open_recording(std::move(recording), options);
}

BagSummary summarise_bag(const fs::path& path) {
  const std::unique_ptr<MessageSource> source = open_bag(path);
  const BagIndex index = index_bag(*source);
  BagSummary summary;
  summary.kind = source->kind();
  summary.topics = source->topics();
  std::stable_sort(summary.topics.begin(), summary.topics.end(),
                   [](const Topic& a, const Topic& b) { return a.name < b.name; });
  summary.notes = source->notes();
  if (const auto topics = choose_topics(index, {}, path.string(), summary.reason)) {
    summary.taken = topics->text();
    for (const auto& [frame, T_frame_left] : frames_of(index, *topics)) summary.frames.push_back(frame);
  }
  return summary;
}

}  // namespace penumbra::slam
