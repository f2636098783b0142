// The messages of sensor_msgs that carry images and cameras, and of tf2_msgs that say where things stand.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "slam/sources/bag/message_reader.h"

namespace penumbra::slam {

// sensor_msgs/Image: rows of pixels. Views of the message's bytes.
struct ImageMessage {
  MessageHeader header;
  std::uint32_t height = 0, width = 0;
  std::string_view encoding;  // "mono8", "bgr8", "16UC1", ...
  bool is_big_endian = false;
  std::uint32_t step = 0;  // bytes from a row to the next
  std::string_view data;
};

// sensor_msgs/CompressedImage: a JPEG or PNG, after 12 bytes of its own where it is compressedDepth.
struct CompressedImageMessage {
  MessageHeader header;
  std::string_view format;  // "jpeg", "rgb8; jpeg compressed bgr8", "16UC1; compressedDepth png", ...
  std::string_view data;
};

// sensor_msgs/CameraInfo, as it stands there.
struct CameraInfoMessage {
  std::string frame;
  std::uint32_t height = 0, width = 0;
  std::string model;      // of the distortion: "plumb_bob", "rational_polynomial", "equidistant", ...
  std::vector<double> D;  // its coefficients
  std::array<double, 9> K{}, R{};
  std::array<double, 12> P{};
  std::uint32_t binning_x = 0, binning_y = 0;  // 0 means 1
  std::uint32_t roi_x = 0, roi_y = 0, roi_height = 0,
                roi_width = 0;  // pixels before binning; all 0: the whole image

  bool operator==(const CameraInfoMessage&) const = default;
};

// geometry_msgs/TransformStamped: p_parent = R(x y z w) p_child + translation.
struct TransformMessage {
  std::string parent, child;
  std::array<double, 3> translation{};  // metres
  std::array<double, 4> rotation{};     // quaternion x y z w
};

// Each throws InputError naming `place` where the bytes are not such a message.
ImageMessage read_image_message(std::string_view bytes, MessageEncoding encoding, std::string_view place);
CompressedImageMessage read_compressed_image(std::string_view bytes, MessageEncoding encoding,
                                             std::string_view place);
CameraInfoMessage read_camera_info(std::string_view bytes, MessageEncoding encoding, std::string_view place);
// tf2_msgs/TFMessage.
std::vector<TransformMessage> read_transforms(std::string_view bytes, MessageEncoding encoding,
                                              std::string_view place);

}  // namespace penumbra::slam
