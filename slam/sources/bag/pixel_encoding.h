// How the pixels of image messages are laid out, by the name of their encoding.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "nn/image/bayer.h"
#include "nn/image/image_file.h"
#include "nn/image/stored_image.h"

namespace penumbra::slam {

// What the encoding of an Image, or the format of a CompressedImage, says of it.
enum class PixelKind { grey, colour, depth, grey_or_depth, unknown };
PixelKind pixel_kind(std::string_view encoding);
PixelKind compressed_pixel_kind(std::string_view format);

enum class PixelLayout { grey8, grey16, rgb, bgr, rgba, bgra, rggb, bggr, gbrg, grbg, uyvy, yuyv, metres };

struct PixelEncoding {
  std::string_view name;
  PixelLayout layout;
  std::size_t bytes;  // a pixel
  PixelKind kind;
};
// Null where it is none of those that are read.
const PixelEncoding* find_encoding(std::string_view name);
std::optional<BayerPattern> bayer_pattern(PixelLayout layout);

// What a CompressedImage was before it was compressed: its format's first word.
std::string_view original_encoding(std::string_view format);
bool is_compressed_depth(std::string_view format);

// What all readers of pixels end in. Throws InputError naming `place` for a mosaic that is too small.
ByteImage checked_demosaic(const ByteView& mosaic, BayerPattern pattern, const std::string& place);
void set_channels(nn::StoredImage& image, nn::ImageColour colour);

inline constexpr double kMillimetres = 1000.0;  // levels a metre, by REP 118

}  // namespace penumbra::slam
