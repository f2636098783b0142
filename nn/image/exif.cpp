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

cv::Mat turn_upright(const cv::Mat& image, int orientation) {
  // From 5 on rows and columns change places; what is then left to do is a flip.
  constexpr int kAboutRows = 0, kAboutColumns = 1, kAboutBoth = -1;  // cv::flip's codes
  cv::Mat turned;
  if (orientation >= 5) {
    cv::transpose(image, turned);
  } else {
    turned = image;
  }
  const auto flipped = [&](int code) {
    cv::Mat result;
    cv::flip(turned, result, code);
    return result;
  };
  switch (orientation) {
    case 2:
    case 6:
      return flipped(kAboutColumns);
    case 3:
    case 7:
      return flipped(kAboutBoth);
    case 4:
    case 8:
      return flipped(kAboutRows);
    default:
      return turned;
  }
}

}  // namespace penumbra::nn
