#include "nn/image/bmp.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

using Colour = std::array<std::uint8_t, 3>;  // blue, green, red

constexpr std::size_t kFileHeader = 14, kInfoHeader = 40;
constexpr std::uint32_t kUncompressed = 0, kBitFields = 3;

std::uint32_t little_endian(std::string_view bytes, std::size_t offset, int size) {
  std::uint32_t value = 0;
  for (int i = 0; i < size; ++i) {
    value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[offset + i])) << (8 * i);
  }
  return value;
}

// The colours of a table, repeated to `count`; entries beyond the file's table are black.
std::vector<Colour> read_colours(std::string_view bytes, std::size_t begin, std::size_t stored,
                                 std::size_t count) {
  std::vector<Colour> colours(count, Colour{});
  for (std::size_t i = 0; i < std::min(stored, count); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      colours[i][c] = static_cast<std::uint8_t>(bytes[begin + 4 * i + c]);
    }
  }
  return colours;
}

bool is_grey(const std::vector<Colour>& colours) {
  return std::all_of(colours.begin(), colours.end(),
                     [](const Colour& bgr) { return bgr[0] == bgr[1] && bgr[1] == bgr[2]; });
}

}  // namespace

bool looks_like_bmp(std::string_view bytes) {
  // "BM" alone begins many a text; the header's size does not.
  return bytes.size() >= kFileHeader + 4 && bytes.starts_with("BM") && little_endian(bytes, 14, 4) <= 256;
}

StoredImage read_bmp(std::string_view bytes, std::string_view place) {
  const auto torn = [&] {
    return InputError(place, "a complete BMP image",
                      fmt::format("a torn file that ends after {} bytes", bytes.size()));
  };
  const std::uint32_t header = little_endian(bytes, kFileHeader, 4);
  if (header < kInfoHeader) {
    throw InputError(place, "a BMP header of 40 or more bytes", fmt::format("{}", header));
  }
  if (bytes.size() < kFileHeader + header) throw torn();
  const std::uint64_t rows_begin = little_endian(bytes, 10, 4);
  const auto height = static_cast<std::int32_t>(little_endian(bytes, 22, 4));
  const std::uint32_t bits = little_endian(bytes, 28, 2), compression = little_endian(bytes, 30, 4);
  StoredImage image;
  image.info = checked_image_size(little_endian(bytes, 18, 4),
                                  static_cast<std::uint64_t>(std::abs(std::int64_t{height})), place);
  const bool has_table = bits == 1 || bits == 4 || bits == 8;
  if (!has_table && bits != 24 && bits != 32) {
    throw InputError(place, "a BMP of 1, 4, 8, 24 or 32 bits a pixel", fmt::format("{}", bits));
  }
  if (compression == kBitFields && bits == 32) {  // which byte is which; V4 headers hold the masks themselves
    const std::size_t masks = kFileHeader + kInfoHeader;
    if (bytes.size() < masks + 12) throw torn();
    if (little_endian(bytes, masks, 4) != 0xFF0000 || little_endian(bytes, masks + 4, 4) != 0xFF00 ||
        little_endian(bytes, masks + 8, 4) != 0xFF) {
      throw InputError(place, "a 32-bit BMP of blue, green and red bytes", "another order");
    }
  } else if (compression != kUncompressed) {
    throw InputError(place, "a BMP without compression", fmt::format("compression {}", compression));
  }
  const std::uint64_t stride = (std::uint64_t{bits} * image.info.width + 31) / 32 * 4;
  const std::uint64_t size = stride * static_cast<std::uint64_t>(image.info.height);
  if (rows_begin > bytes.size() || bytes.size() - rows_begin < size) throw torn();

  std::vector<Colour> colours;
  if (has_table) {
    const std::size_t count = std::size_t{1} << bits, named = little_endian(bytes, 46, 4);
    const std::size_t begin = kFileHeader + header, stored = named == 0 ? count : std::min(named, count);
    if (bytes.size() < begin + 4 * stored) throw torn();
    colours = read_colours(bytes, begin, stored, count);
  }
  const bool grey = has_table && is_grey(colours);
  image.bytes.create(image.info.width, image.info.height, grey ? 1 : 3);
  for (int y = 0; y < image.info.height; ++y) {
    const int stored_row = height < 0 ? y : image.info.height - 1 - y;
    const std::string_view row = bytes.substr(rows_begin + stride * static_cast<std::uint64_t>(stored_row));
    for (std::size_t x = 0; x < static_cast<std::size_t>(image.info.width); ++x) {
      Colour bgr{};
      if (has_table) {
        const std::size_t bit = x * bits;
        const unsigned shift =
            8 - bits - static_cast<unsigned>(bit % 8);  // the leftmost pixel is the high one
        bgr = colours[static_cast<std::uint8_t>(row[bit / 8]) >> shift & ((1U << bits) - 1)];
      } else {
        for (std::size_t c = 0; c < 3; ++c) {
          bgr[c] = static_cast<std::uint8_t>(row[x * bits / 8 + c]);
        }
      }
      std::copy_n(bgr.begin(), image.bytes.channels(), &image.bytes.at(static_cast<int>(x), y));
    }
  }
  return image;
}

}  // namespace penumbra::nn
