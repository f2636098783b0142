// What of a recording a dataset needs: where its images lie, their times, and its cameras. One reading
// forward.
//
// Memory: 32 bytes an image.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/sources/bag/image_pixels.h"
#include "slam/sources/bag/message_source.h"
#include "slam/sources/bag/messages.h"
#include "slam/sources/bag/pixel_encoding.h"

namespace penumbra::slam {

struct IndexedImage {
  std::int64_t time = 0;  // nanoseconds: of the header, or of recording where the header's is 0
  MessagePlace place;
};

struct ImageTopic {
  std::size_t topic = 0;  // in MessageSource::topics()
  std::string name;
  MessageEncoding encoding = MessageEncoding::other;  // of the messages
  bool is_compressed = false;                         // sensor_msgs/CompressedImage
  // Of the first message:
  std::string format;                   // its encoding, or format
  PixelKind kind = PixelKind::unknown;  // mono16 counts as depth where the topic's name has "depth"
  std::string frame;
  Size size;  // 0 x 0 where it is compressed

  std::vector<IndexedImage> images;  // in the order of their times
  std::size_t without_stamp = 0;     // whose header has no time
  std::size_t backwards = 0;         // whose time is before that of the message before
  std::size_t damaged = 0;           // messages that are no images

  bool is_depth() const { return kind == PixelKind::depth; }
};

struct CameraTopic {
  std::size_t topic = 0;
  std::string name;
  CameraInfoMessage info;   // the first
  std::size_t changes = 0;  // messages that say something else
};

struct BagIndex {
  std::vector<ImageTopic> images;    // topics with at least one image, in the order of their names
  std::vector<CameraTopic> cameras;  // likewise
  // Where frames stand in their parents: the last of /tf_static, and of /tf those that never change by more
  // than 0.1 mm or 0.1 mrad.
  std::vector<TransformMessage> fixed;
};

BagIndex index_bag(MessageSource& source);

}  // namespace penumbra::slam
