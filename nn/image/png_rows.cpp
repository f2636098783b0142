#include "nn/image/png_rows.h"

#include <libdeflate.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace penumbra::nn {

namespace {

constexpr std::size_t kChunkHead = 8, kChunkCheck = 4;  // bytes before and behind a chunk's data
constexpr std::size_t kSignatureBytes = 8;

std::uint32_t big_endian_word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

// What the chunks of a plain PNG say; the packed pixels of all of them together.
struct PlainPng {
  bool is_plain = false;
  int depth = 8, channels = 1;  // bits a channel
  std::string packed;
};

// Unpacks a zlib stream to exactly `size` bytes; false where it is damaged or has another size.
bool inflate_all(std::string_view stream, std::uint8_t* output, std::size_t size) {
  thread_local const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>
      unpacker(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  return unpacker != nullptr && libdeflate_zlib_decompress(unpacker.get(), stream.data(), stream.size(),
                                                           output, size, nullptr) == LIBDEFLATE_SUCCESS;
}

PlainPng read_chunks(std::string_view bytes) {
  PlainPng png;
  std::size_t at = kSignatureBytes;
  bool ends = false;
  while (!ends && bytes.size() - at >= kChunkHead + kChunkCheck) {
    const std::size_t length = big_endian_word(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - kChunkHead - kChunkCheck) return png;
    const std::string_view data = bytes.substr(at + kChunkHead, length);
    if (type == "IHDR") {
      const int depth = static_cast<std::uint8_t>(data[8]), colour = static_cast<std::uint8_t>(data[9]);
      const bool is_known = (colour == 0 && (depth == 8 || depth == 16)) || (colour == 2 && depth == 8);
      const bool is_usual =
          data[10] == 0 && data[11] == 0 && data[12] == 0;  // packing, filters, no interlacing
      if (!is_known || !is_usual) return png;
      png.depth = depth;
      png.channels = colour == 2 ? 3 : 1;
      png.packed.reserve(bytes.size());
    } else if (type == "IDAT") {
      png.packed += data;
    } else if (type != "IEND") {
      return png;
    }
    ends = type == "IEND";
    at += kChunkHead + length + kChunkCheck;
  }
  png.is_plain = ends;
  return png;
}

std::uint8_t nearest_of_three(int a, int b, int c) {
  const int from_a = std::abs(b - c), from_b = std::abs(a - c), from_c = std::abs(a + b - 2 * c);
  const int of_b_and_c = from_b <= from_c ? b : c;
  return static_cast<std::uint8_t>(from_a <= from_b && from_a <= from_c ? a : of_b_and_c);
}

// Undoes a row's filter in place. `above`: the row before, undone.
template <int step>
bool undo_filter(int filter, std::uint8_t* row, const std::uint8_t* above, int count) {
  std::array<std::uint8_t, step> left{}, corner{};
  const auto for_each = [&](auto&& undone) {
    for (int i = 0; i < count; i += step) {
      for (int k = 0; k < step; ++k) {
        const auto at = static_cast<std::size_t>(k);
        left[at] = row[i + k] =
            static_cast<std::uint8_t>(row[i + k] + undone(left[at], above[i + k], corner[at]));
        corner[at] = above[i + k];
      }
    }
  };
  switch (filter) {
    case 0:
      return true;
    case 1:
      for_each([](int a, int /*b*/, int /*c*/) { return a; });
      return true;
    case 2:
      for (int i = 0; i < count; ++i) row[i] = static_cast<std::uint8_t>(row[i] + above[i]);
      return true;
    case 3:
      for_each([](int a, int b, int /*c*/) { return (a + b) / 2; });
      return true;
    case 4:
      for_each([](int a, int b, int c) { return nearest_of_three(a, b, c); });
      return true;
    default:
      return false;
  }
}

// Bytes of pixels as the image has them.
void put_row(const std::uint8_t* row, int width, std::uint8_t* out, int channels) {
  if (channels == 1) {
    std::memcpy(out, row, static_cast<std::size_t>(width));
    return;
  }
  for (int i = 0; i < 3 * width; i += 3) {
    out[i] = row[i + 2];
    out[i + 1] = row[i + 1];
    out[i + 2] = row[i];
  }
}
void put_row(const std::uint8_t* row, int width, std::uint16_t* out, int /*channels*/) {
  for (int x = 0; x < width; ++x) out[x] = static_cast<std::uint16_t>((row[2 * x] << 8) | row[2 * x + 1]);
}

template <int step, class T>
bool undo_rows(std::uint8_t* rows, Image<T>& image) {
  const int count = image.width() * step;
  const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(count), 0);
  const std::uint8_t* above = nothing.data();
  for (int y = 0; y < image.height(); ++y) {
    std::uint8_t* row = rows + static_cast<std::ptrdiff_t>(y) * (count + 1) + 1;
    if (!undo_filter<step>(row[-1], row, above, count)) return false;
    put_row(row, image.width(), image.row(y), image.channels());
    above = row;
  }
  return true;
}

}  // namespace

bool decode_plain_png(std::string_view bytes, ImageColour colour, bool eight_bits, StoredImage& image) {
  const PlainPng png = read_chunks(bytes);
  const bool is_wanted =
      colour == ImageColour::stored || png.channels == (colour == ImageColour::bgr ? 3 : 1);
  if (!png.is_plain || !is_wanted || (png.depth == 16 && eight_bits)) return false;
  const std::size_t step = static_cast<std::size_t>(png.channels * png.depth / 8);
  const auto width = static_cast<std::size_t>(image.info.width),
             height = static_cast<std::size_t>(image.info.height);
  const std::size_t size = (step * width + 1) * height;
  const std::unique_ptr<std::uint8_t[]> rows(new std::uint8_t[size]);
  if (!inflate_all(png.packed, rows.get(), size)) return false;
  if (png.depth == 16) {
    image.words.create(image.info.width, image.info.height);
    return undo_rows<2>(rows.get(), image.words);
  }
  image.bytes.create(image.info.width, image.info.height, png.channels);
  return png.channels == 3 ? undo_rows<3>(rows.get(), image.bytes) : undo_rows<1>(rows.get(), image.bytes);
}

}  // namespace penumbra::nn
