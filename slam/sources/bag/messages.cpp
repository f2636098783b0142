#include "slam/sources/bag/messages.h"

namespace penumbra::slam {

ImageMessage read_image_message(std::string_view bytes, MessageEncoding encoding, std::string_view place) {
  MessageReader reader(bytes, encoding, place);
  ImageMessage image;
  image.header = reader.header();
  image.height = reader.number<std::uint32_t>();
  image.width = reader.number<std::uint32_t>();
  image.encoding = reader.text();
  image.is_big_endian = reader.number<std::uint8_t>() != 0;
  image.step = reader.number<std::uint32_t>();
  image.data = reader.byte_list();
  return image;
}

CompressedImageMessage read_compressed_image(std::string_view bytes, MessageEncoding encoding,
                                             std::string_view place) {
  MessageReader reader(bytes, encoding, place);
  CompressedImageMessage image;
  image.header = reader.header();
  image.format = reader.text();
  image.data = reader.byte_list();
  return image;
}

CameraInfoMessage read_camera_info(std::string_view bytes, MessageEncoding encoding, std::string_view place) {
  MessageReader reader(bytes, encoding, place);
  CameraInfoMessage info;
  info.frame = reader.header().frame;
  info.height = reader.number<std::uint32_t>();
  info.width = reader.number<std::uint32_t>();
  info.model = reader.text();
  info.D = reader.number_list();
  info.K = reader.numbers<9>();
  info.R = reader.numbers<9>();
  info.P = reader.numbers<12>();
  info.binning_x = reader.number<std::uint32_t>();
  info.binning_y = reader.number<std::uint32_t>();
  info.roi_x = reader.number<std::uint32_t>();
  info.roi_y = reader.number<std::uint32_t>();
  info.roi_height = reader.number<std::uint32_t>();
  info.roi_width = reader.number<std::uint32_t>();
  return info;
}

std::vector<TransformMessage> read_transforms(std::string_view bytes, MessageEncoding encoding,
                                              std::string_view place) {
  MessageReader reader(bytes, encoding, place);
  const auto count = reader.number<std::uint32_t>();
  std::vector<TransformMessage> transforms;
  for (std::uint32_t i = 0; i < count; ++i) {  // ends by itself where the bytes do
    TransformMessage transform;
    transform.parent = reader.header().frame;
    transform.child = reader.text();
    transform.translation = reader.numbers<3>();
    transform.rotation = reader.numbers<4>();
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

}  // namespace penumbra::slam
