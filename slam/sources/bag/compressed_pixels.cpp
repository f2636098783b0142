// The pixels of CompressedImage messages (image_pixels.h).
#include <algorithm>
#include <cstring>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/image/levels.h"
#include "slam/sources/bag/image_pixels.h"
#include "slam/sources/bag/pixel_encoding.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

WordImage png_levels(std::string_view bytes, const fs::path& place) {
  const nn::StoredImage image =
      nn::decode_image(std::string(bytes), nn::ImageColour::stored, nn::ImageBits::stored, place);
  if (!image.is_wide() || image.channels() != 1) {
    throw InputError(
        place.string(), "a 16-bit grey PNG with depth",
        fmt::format("{} of {} bits", counted(image.channels(), "channel"), image.is_wide() ? 16 : 8));
  }
  return image.words;
}

}  // namespace

nn::StoredImage pixels_of(const CompressedImageMessage& image, nn::ImageColour colour, nn::ImageBits bits,
                          const fs::path& place) {
  // A mosaic that was compressed as it is comes as a grey image.
  const PixelEncoding* original = find_encoding(original_encoding(image.format));
  const std::optional<BayerPattern> pattern = original ? bayer_pattern(original->layout) : std::nullopt;
  nn::StoredImage result =
      nn::decode_image(std::string(image.data), pattern ? nn::ImageColour::stored : colour, bits, place);
  if (!pattern) return result;
  if (!result.is_wide() && result.channels() == 1)
    result.bytes = checked_demosaic(result.bytes, *pattern, place.string());
  set_channels(result, colour);
  return result;
}

nn::ImageInfo info_of(const CompressedImageMessage& image, const fs::path& place) {
  return nn::image_info(std::string(image.data), place);
}

FloatImage depth_of(const CompressedImageMessage& image, const fs::path& place) {
  if (!is_compressed_depth(image.format)) return metres_of(png_levels(image.data, place), kMillimetres);
  constexpr std::size_t kBefore = 12;
  if (image.format.find("rvl") != std::string_view::npos)
    throw InputError(place.string(), "compressedDepth by PNG (the node's png_level)", "by RVL");
  if (image.data.size() < kBefore)
    throw InputError(place.string(), "12 bytes before the PNG", fmt::format("{}", image.data.size()));
  const WordImage levels = png_levels(image.data.substr(kBefore), place);
  if (original_encoding(image.format) != "32FC1") return metres_of(levels, kMillimetres);
  float a = 0.0F, b = 0.0F;
  std::memcpy(&a, image.data.data() + 4, sizeof(a));
  std::memcpy(&b, image.data.data() + 8, sizeof(b));
  FloatImage depth(levels.width(), levels.height());
  std::transform(levels.data(), levels.data() + levels.elements(), depth.data(), [a, b](std::uint16_t level) {
    return level == 0 ? 0.0F : a / (static_cast<float>(level) - b);
  });
  return known_metres(std::move(depth));
}

}  // namespace penumbra::slam
