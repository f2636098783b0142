// The pixels of image messages.
//
//   grey, colour   mono8 8UC1 mono16 16UC1 rgb8 bgr8 8UC3 rgba8 bgra8 8UC4 bayer_{rggb,bggr,gbrg,grbg}8
//                  yuv422 uyvy yuv422_yuy2 yuyv; JPEG and PNG (bayer in a grey one, if the format says so)
//   depth          16UC1 mono16: millimetres; 32FC1: metres; 0, negative and not a number: unknown
//   compressedDepth   12 bytes (u32, float A, float B), then a PNG of 16 bits: millimetres of 16UC1; of 32FC1
//                  depth = A / (level - B), level 0: unknown
//
// Sources: sensor_msgs/image_encodings.h; REP 118 (depth images); compressed_depth_image_transport
// (codec.cpp).
#pragma once

#include <filesystem>
#include <string_view>

#include "nn/image/image_file.h"
#include "slam/sources/bag/messages.h"

namespace penumbra::slam {

// As nn::decode_image. Throw InputError naming `place` where the encoding is none of the above, where bytes
// are missing, and for images that are damaged.
nn::StoredImage pixels_of(const ImageMessage& image, nn::ImageColour colour, nn::ImageBits bits,
                          const std::filesystem::path& place);
nn::StoredImage pixels_of(const CompressedImageMessage& image, nn::ImageColour colour, nn::ImageBits bits,
                          const std::filesystem::path& place);
// Its size and bits a channel.
nn::ImageInfo info_of(const ImageMessage& image, const std::filesystem::path& place);
nn::ImageInfo info_of(const CompressedImageMessage& image, const std::filesystem::path& place);
// Metres, 0 where unknown.
FloatImage depth_of(const ImageMessage& image, const std::filesystem::path& place);
FloatImage depth_of(const CompressedImageMessage& image, const std::filesystem::path& place);

}  // namespace penumbra::slam
