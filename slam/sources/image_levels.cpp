#include "slam/sources/image_levels.h"

#include <fmt/core.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/image/levels.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kLookedAt = 16;  // images

// The highest level of images from all over the recording. Those that cannot be read are for the run to
// report.
int highest_level(const ImageReader& reader, std::span<const ImageKey> images) {
  int highest = 0;
  const std::size_t count = std::min(kLookedAt, images.size());
  for (std::size_t i = 0; i < count; ++i) {
    try {
      const WordImage words =
          reader.read(images[i * images.size() / count], nn::ImageColour::grey, nn::ImageBits::stored).words;
      if (words.empty()) continue;
      highest = std::max<int>(highest, *std::max_element(words.data(), words.data() + words.elements()));
    } catch (const InputError&) {
      continue;
    }
  }
  return highest;
}

int bits_for(int level) {
  for (const int bits : {8, 10, 12, 14}) {
    if (level < 1 << bits) return bits;
  }
  return 16;
}

}  // namespace

ImageLevels::ImageLevels(const ImageReader& reader, std::span<const ImageKey> images, std::optional<int> bits,
                         std::vector<std::string>& notes) {
  if (bits && (*bits < 8 || *bits > 16)) {
    throw UsageError(fmt::format("--image-bits {}: expected 8 to 16", *bits));
  }
  const nn::ImageInfo info = reader.info(images.front());
  if (info.bit_depth != 16) {
    if (bits && *bits != 8) {
      notes.push_back(
          fmt::format("--image-bits {} is of no use: the images have {} bits", *bits, info.bit_depth));
    }
    return;
  }
  const int highest = highest_level(reader, images);
  const bool file_says = info.significant_bits < 16 && highest < 1 << info.significant_bits;
  bits_ = bits ? *bits : file_says ? std::max(8, info.significant_bits) : bits_for(highest);
  notes.push_back(
      fmt::format("16-bit images: {} bits are taken to be used{} (levels up to {} in the images "
                  "looked at; --image-bits N sets them)",
                  bits_,
                  bits        ? " as asked for"
                  : file_says ? " as the files say"
                              : "",
                  highest));
  if (highest >= 1 << bits_) {
    notes.push_back(fmt::format("levels above {} become white", (1 << bits_) - 1));
  }
}

ByteImage ImageLevels::read(const ImageReader& reader, const ImageKey& key, nn::ImageColour colour) const {
  if (bits_ == 0 || bits_ == 16) return reader.read(key, colour, nn::ImageBits::eight).bytes;
  const nn::StoredImage image = reader.read(key, colour, nn::ImageBits::stored);
  if (!image.is_wide()) return image.bytes;
  return upper_bits(image.words, bits_);
}

}  // namespace penumbra::slam
