#include "slam/sources/bag/bag_index.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

bool is_same_place(const TransformMessage& a, const TransformMessage& b) {
  constexpr double kMetres = 1e-4, kRadians = 1e-4;
  const auto farthest = [](const auto& u, const auto& v, double sign) {
    double most = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) most = std::max(most, std::abs(u[i] - sign * v[i]));
    return most;
  };
  // q and -q are one rotation; half its angle is in q.
  const double turn =
      2.0 * std::min(farthest(a.rotation, b.rotation, 1.0), farthest(a.rotation, b.rotation, -1.0));
  return a.parent == b.parent && farthest(a.translation, b.translation, 1.0) <= kMetres && turn <= kRadians;
}

class Indexer {
 public:
  explicit Indexer(const MessageSource& source) : source_(source) {}

  void take(const Message& message) {
    const Topic& topic = source_.topics()[message.topic];
    const MessageEncoding encoding = topic.message_encoding();
    if (encoding == MessageEncoding::other) return;
    if (topic.type == "sensor_msgs/Image" || topic.type == "sensor_msgs/CompressedImage") {
      take_image(message, topic, encoding);
    } else if (topic.type == "sensor_msgs/CameraInfo") {
      take_camera(message, topic, encoding);
    } else if (topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage") {
      take_transforms(message, topic, encoding);
    }
  }

  BagIndex finish() {
    BagIndex index;
    for (auto& [topic, images] : images_) {
      if (images.images.empty()) continue;
      const auto is_earlier = [](const IndexedImage& a, const IndexedImage& b) { return a.time < b.time; };
      std::stable_sort(images.images.begin(), images.images.end(), is_earlier);
      index.images.push_back(std::move(images));
    }
    for (auto& [topic, camera] : cameras_) index.cameras.push_back(std::move(camera));
    for (auto& [child, frame] : frames_) {
      if (!frame.moves) index.fixed.push_back(std::move(frame.transform));
    }
    const auto by_name = [](const auto& a, const auto& b) { return a.name < b.name; };
    std::stable_sort(index.images.begin(), index.images.end(), by_name);
    std::stable_sort(index.cameras.begin(), index.cameras.end(), by_name);
    return index;
  }

 private:
  void take_image(const Message& message, const Topic& topic, MessageEncoding encoding) {
    const auto [at, is_new] = images_.try_emplace(message.topic);
    ImageTopic& images = at->second;
    if (is_new) {
      images.topic = message.topic;
      images.name = topic.name;
      images.encoding = encoding;
      images.is_compressed = topic.type == "sensor_msgs/CompressedImage";
    }
    try {
      MessageHeader header;
      if (images.is_compressed) {
        const CompressedImageMessage image = read_compressed_image(message.bytes, encoding, topic.name);
        header = image.header;
        if (images.images.empty())
          describe(images, image.format, compressed_pixel_kind(image.format), header, {});
      } else {
        const ImageMessage image = read_image_message(message.bytes, encoding, topic.name);
        header = image.header;
        const Size size{static_cast<int>(image.width), static_cast<int>(image.height)};
        if (images.images.empty()) describe(images, image.encoding, pixel_kind(image.encoding), header, size);
      }
      const std::int64_t time = header.stamp == 0 ? message.record_time : header.stamp;
      images.without_stamp += header.stamp == 0 ? 1 : 0;
      images.backwards += !images.images.empty() && time < images.images.back().time ? 1 : 0;
      images.images.push_back({time, message.place});
    } catch (const InputError&) {
      ++images.damaged;
    }
  }

  static void describe(ImageTopic& images, std::string_view format, PixelKind kind,
                       const MessageHeader& header, const Size& size) {
    images.format = format;
    if (kind == PixelKind::grey_or_depth)
      kind = lower_case(images.name).find("depth") == std::string::npos ? PixelKind::grey : PixelKind::depth;
    images.kind = kind;
    images.frame = header.frame;
    images.size = size;
  }

  void take_camera(const Message& message, const Topic& topic, MessageEncoding encoding) {
    CameraInfoMessage info;
    try {
      info = read_camera_info(message.bytes, encoding, topic.name);
    } catch (const InputError&) {
      return;
    }
    const auto [at, is_new] = cameras_.try_emplace(message.topic);
    if (is_new) {
      at->second = {message.topic, topic.name, std::move(info), 0};
    } else if (!(info == at->second.info)) {
      ++at->second.changes;
    }
  }

  void take_transforms(const Message& message, const Topic& topic, MessageEncoding encoding) {
    constexpr std::size_t kMost = 10'000;  // frames of a robot
    const bool is_static = topic.name.ends_with("tf_static");
    try {
      for (TransformMessage& transform : read_transforms(message.bytes, encoding, topic.name)) {
        if (frames_.size() < kMost || frames_.contains(transform.child)) take_transform(transform, is_static);
      }
    } catch (const InputError&) {
      return;
    }
  }

  // What /tf_static says is the last word; of /tf a frame that ever moves does not stand.
  void take_transform(TransformMessage& transform, bool is_static) {
    const auto [at, is_new] = frames_.try_emplace(transform.child);
    Frame& frame = at->second;
    if (is_new || is_static) {
      frame = {std::move(transform), is_static, false};
    } else if (!frame.is_static) {
      frame.moves = frame.moves || !is_same_place(frame.transform, transform);
    }
  }

  struct Frame {
    TransformMessage transform;
    bool is_static = false, moves = false;
  };

  const MessageSource& source_;
  std::map<std::string, Frame> frames_;  // by the frame that stands in another
  std::map<std::size_t, ImageTopic> images_;
  std::map<std::size_t, CameraTopic> cameras_;
};

}  // namespace

BagIndex index_bag(MessageSource& source) {
  Indexer indexer(source);
  source.read_all([&](const Message& message) { indexer.take(message); });
  return indexer.finish();
}

}  // namespace penumbra::slam
