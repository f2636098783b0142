#include "nn/image/exif.h"

#include <cstdint>

namespace penumbra::nn {

namespace {

constexpr std::string_view kPrefix("Exif\0\0", 6);
constexpr std::uint32_t kOrientationTag = 0x0112;
constexpr std::size_t kEntrySize = 12;  // tag, type, count, value
constexpr std::uint32_t kShort = 3, kLong = 4;

// Whole numbers of a TIFF file, 0 where they lie outside of it.
class TiffNumbers {
 public:
  explicit TiffNumbers(std::string_view bytes) : bytes_(bytes), big_endian_(bytes.starts_with("MM")) {}

  std::uint32_t at(std::uint64_t offset, std::size_t size) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t place = big_endian_ ? i : size - 1 - i;
      value = value << 8 | static_cast<std::uint8_t>(bytes_[offset + place]);
    }
    return value;
  }

 private:
  std::string_view bytes_;
  bool big_endian_;
};

}  // namespace

int exif_orientation(std::string_view exif) {
  if (exif.starts_with(kPrefix)) exif.remove_prefix(kPrefix.size());
  if (!exif.starts_with("II") && !exif.starts_with("MM")) return kUpright;
  const TiffNumbers tiff(exif);
  if (tiff.at(2, 2) != 42) return kUpright;
  const std::uint64_t list = tiff.at(4, 4);
  const std::uint32_t entries = tiff.at(list, 2);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const std::uint64_t entry = list + 2 + i * kEntrySize;
    if (entry + kEntrySize > exif.size()) break;
    if (tiff.at(entry, 2) != kOrientationTag) continue;
    const std::uint32_t type = tiff.at(entry + 2, 2);
    const std::uint32_t value = type == kShort  ? tiff.at(entry + 8, 2)
                                : type == kLong ? tiff.at(entry + 8, 4)
                                                : 0;
    return value >= 1 && value <= 8 ? static_cast<int>(value) : kUpright;
  }
  return kUpright;
}

ByteImage turn_upright(const ByteImage& image, int orientation) {
  if (orientation == kUpright) return image;
  // From 5 on rows and columns change places; what is then left to do is a flip.
  const bool transposed = orientation >= 5;
  const bool about_columns = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool about_rows = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  const int width = transposed ? image.height() : image.width();
  const int height = transposed ? image.width() : image.height();
  ByteImage turned(width, height, image.channels());
  for (int y = 0; y < height; ++y) {
    const int v = about_rows ? height - 1 - y : y;
    for (int x = 0; x < width; ++x) {
      const int u = about_columns ? width - 1 - x : x;
      const std::uint8_t* pixel = transposed ? &image.at(v, u) : &image.at(u, v);
      for (int c = 0; c < image.channels(); ++c) turned.at(x, y, c) = pixel[c];
    }
  }
  return turned;
}

}  // namespace penumbra::nn
