#include "slam/sources/bag/pixel_encoding.h"

#include <algorithm>

#include "nn/base/error.h"
#include "nn/image/colour.h"

namespace penumbra::slam {

namespace {

constexpr PixelEncoding kEncodings[] = {
    {"mono8", PixelLayout::grey8, 1, PixelKind::grey},
    {"8UC1", PixelLayout::grey8, 1, PixelKind::grey},
    {"mono16", PixelLayout::grey16, 2, PixelKind::grey_or_depth},
    {"16UC1", PixelLayout::grey16, 2, PixelKind::depth},
    {"rgb8", PixelLayout::rgb, 3, PixelKind::colour},
    {"bgr8", PixelLayout::bgr, 3, PixelKind::colour},
    {"8UC3", PixelLayout::bgr, 3, PixelKind::colour},
    {"rgba8", PixelLayout::rgba, 4, PixelKind::colour},
    {"bgra8", PixelLayout::bgra, 4, PixelKind::colour},
    {"8UC4", PixelLayout::bgra, 4, PixelKind::colour},
    {"bayer_rggb8", PixelLayout::rggb, 1, PixelKind::colour},
    {"bayer_bggr8", PixelLayout::bggr, 1, PixelKind::colour},
    {"bayer_gbrg8", PixelLayout::gbrg, 1, PixelKind::colour},
    {"bayer_grbg8", PixelLayout::grbg, 1, PixelKind::colour},
    {"yuv422", PixelLayout::uyvy, 2, PixelKind::colour},
    {"uyvy", PixelLayout::uyvy, 2, PixelKind::colour},
    {"yuv422_yuy2", PixelLayout::yuyv, 2, PixelKind::colour},
    {"yuyv", PixelLayout::yuyv, 2, PixelKind::colour},
    {"32FC1", PixelLayout::metres, 4, PixelKind::depth},
};

}  // namespace

const PixelEncoding* find_encoding(std::string_view name) {
  const auto found = std::find_if(std::begin(kEncodings), std::end(kEncodings),
                                  [&](const PixelEncoding& encoding) { return encoding.name == name; });
  return found == std::end(kEncodings) ? nullptr : found;
}

std::string_view original_encoding(std::string_view format) { return format.substr(0, format.find(';')); }
bool is_compressed_depth(std::string_view format) {
  return format.find("compressedDepth") != std::string_view::npos;
}

PixelKind pixel_kind(std::string_view encoding) {
  const PixelEncoding* found = find_encoding(encoding);
  return found == nullptr ? PixelKind::unknown : found->kind;
}

PixelKind compressed_pixel_kind(std::string_view format) {
  if (is_compressed_depth(format)) return PixelKind::depth;
  const PixelEncoding* found = find_encoding(original_encoding(format));
  return found == nullptr ? PixelKind::colour : found->kind;
}

std::optional<BayerPattern> bayer_pattern(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::rggb:
      return BayerPattern::rggb;
    case PixelLayout::bggr:
      return BayerPattern::bggr;
    case PixelLayout::gbrg:
      return BayerPattern::gbrg;
    case PixelLayout::grbg:
      return BayerPattern::grbg;
    default:
      return std::nullopt;
  }
}

ByteImage checked_demosaic(const ByteView& mosaic, BayerPattern pattern, const std::string& place) {
  if (mosaic.width < 2 || mosaic.height < 2)
    throw InputError(place, "a bayer image of at least 2 x 2 pixels",
                     fmt::format("{} x {}", mosaic.width, mosaic.height));
  return demosaic(mosaic, pattern);
}

void set_channels(nn::StoredImage& image, nn::ImageColour colour) {
  if (colour == nn::ImageColour::stored) return;
  const int channels = colour == nn::ImageColour::grey ? 1 : 3;
  if (image.is_wide()) {
    image.words = with_channels(image.words, channels);
  } else {
    image.bytes = with_channels(image.bytes, channels);
  }
}

}  // namespace penumbra::slam
