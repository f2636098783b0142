#include "nn/image/image_container.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "nn/base/crc32.h"
#include "nn/base/error.h"
#include "nn/image/exif.h"

namespace penumbra::nn {

namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kChunkFrame = 12;  // length, type and CRC around a chunk's data
// Deflate cannot shrink data by more than this factor, so fewer bytes cannot hold the picture.
constexpr std::uint64_t kMaxDeflateRatio = 1032;
// A JPEG's Huffman codes give every block of 8 x 8 pixels at least one bit, so a byte holds at most 512
// pixels; twice that where the components are subsampled across each other (4 x 1 and 1 x 4).
constexpr std::uint64_t kMaxJpegPixelsPerByte = 1024;

std::uint32_t big_endian(std::string_view bytes, std::size_t offset, int size) {
  std::uint32_t value = 0;
  for (int i = 0; i < size; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[offset + i]);
  return value;
}

// The most that a channel has; the depth where the chunk says nothing that makes sense.
int significant_bits(std::string_view chunk, int depth) {
  int most = 0;
  for (const char bits : chunk) most = std::max<int>(most, static_cast<std::uint8_t>(bits));
  return most >= 1 && most <= depth ? most : depth;
}

[[noreturn]] void throw_torn(std::string_view format, std::size_t size, std::string_view place) {
  throw InputError(place, fmt::format("a complete {} image", format),
                   fmt::format("a torn file that ends after {} bytes", size));
}

}  // namespace

ImageInfo checked_image_size(std::uint64_t width, std::uint64_t height, std::string_view place) {
  if (width == 0 || height == 0 || width > static_cast<std::uint64_t>(kMaxImagePixels) ||
      height > static_cast<std::uint64_t>(kMaxImagePixels) ||
      width * height > static_cast<std::uint64_t>(kMaxImagePixels)) {
    throw InputError(place, fmt::format("an image of 1 to {} pixels", kMaxImagePixels),
                     fmt::format("a header that claims {} x {} pixels", width, height));
  }
  ImageInfo info;
  info.width = static_cast<int>(width);
  info.height = static_cast<int>(height);
  return info;
}

bool looks_like_png(std::string_view bytes) { return bytes.substr(0, kPngSignature.size()) == kPngSignature; }

bool looks_like_jpeg(std::string_view bytes) { return bytes.substr(0, 3) == "\xFF\xD8\xFF"; }

ImageInfo check_png(std::string& bytes, std::string_view place) {
  const std::string_view view = bytes;
  ImageInfo info;
  std::uint64_t bits_per_pixel = 0, pixel_bytes = 0;
  std::size_t kept = kPngSignature.size();  // end of the chunks kept, moved together at the front
  for (std::size_t offset = kPngSignature.size();;) {
    if (view.size() - offset < kChunkFrame) throw_torn("PNG", view.size(), place);
    const std::size_t length = big_endian(view, offset, 4);
    if (length > view.size() - offset - kChunkFrame) throw_torn("PNG", view.size(), place);
    const std::string type(view.substr(offset + 4, 4));
    if (crc32(view.substr(offset + 4, 4 + length)) != big_endian(view, offset + 8 + length, 4)) {
      throw InputError(fmt::format("{}, byte {}", place, offset), "a PNG chunk with the right checksum",
                       "a damaged chunk");
    }
    const bool is_first = offset == kPngSignature.size();
    if (is_first != (type == "IHDR") || (is_first && length != 13)) {
      throw InputError(fmt::format("{}, byte {}", place, offset), "one PNG header, before all else",
                       "a chunk out of place");
    }
    if (is_first) {
      info = checked_image_size(big_endian(view, offset + 8, 4), big_endian(view, offset + 12, 4), place);
      static constexpr std::array<int, 7> kChannels = {1, 0, 3, 1, 2, 0, 4};  // by colour type; 0: undefined
      const std::uint32_t depth = big_endian(view, offset + 16, 1), colour = big_endian(view, offset + 17, 1);
      bits_per_pixel = colour < kChannels.size() ? depth * static_cast<std::uint64_t>(kChannels[colour]) : 0;
      if (bits_per_pixel == 0 || depth > 16) {
        throw InputError(place, "a PNG of a known colour type and depth",
                         fmt::format("colour type {}, {} bits", colour, depth));
      }
      info.bit_depth = info.significant_bits = static_cast<int>(depth);
    }
    const std::string_view data = view.substr(offset + 8, length);
    if (type == "sBIT") info.significant_bits = significant_bits(data, info.bit_depth);
    if (type == "eXIf") info.orientation = exif_orientation(data);
    if (type == "IDAT") pixel_bytes += length;
    // tRNS is left out as well: transparency is not decoded.
    if (type == "IHDR" || type == "PLTE" || type == "IDAT" || type == "IEND") {
      if (kept != offset) {
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), kChunkFrame + length,
                    bytes.begin() + static_cast<std::ptrdiff_t>(kept));
      }
      kept += kChunkFrame + length;
    }
    offset += kChunkFrame + length;
    if (type == "IEND") break;
  }
  bytes.resize(kept);
  const std::uint64_t raw_bytes =
      bits_per_pixel * static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height) / 8;
  if (raw_bytes > kMaxDeflateRatio * pixel_bytes) {
    throw InputError(place, fmt::format("pixels of a {} x {} PNG", info.width, info.height),
                     fmt::format("only {} compressed bytes", pixel_bytes));
  }
  return info;
}

ImageInfo check_jpeg(std::string_view bytes, std::string_view place) {
  ImageInfo info;
  bool has_scan = false, has_exif = false;
  int orientation = kUpright;
  std::size_t offset = 2;
  while (true) {
    // Between segments, and after the entropy-coded rows of a scan, stands 0xFF and a code that is not 0
    // (an escaped 0xFF of the rows), not 0xFF (filling) and not a marker without a segment (TEM 0x01,
    // restarts 0xD0..0xD7).
    const std::size_t found = bytes.find('\xFF', offset);
    if (found == std::string_view::npos || found + 1 >= bytes.size()) throw_torn("JPEG", bytes.size(), place);
    const std::uint32_t code = big_endian(bytes, found + 1, 1);
    if (code <= 0x01 || (code >= 0xD0 && code <= 0xD7)) {
      offset = found + 2;
      continue;
    }
    if (code == 0xFF) {
      offset = found + 1;
      continue;
    }
    if (code == 0xD9) break;
    if (bytes.size() - found < 4) throw_torn("JPEG", bytes.size(), place);
    const std::size_t length = big_endian(bytes, found + 2, 2);
    if (length < 2) {
      throw InputError(fmt::format("{}, byte {}", place, found), "a JPEG segment of 2 or more bytes",
                       fmt::format("{}", length));
    }
    if (length > bytes.size() - found - 2) throw_torn("JPEG", bytes.size(), place);
    // Start of frame: 0xC0..0xCF but for the tables DHT (C4), JPG (C8) and DAC (CC).
    const bool is_frame = code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
    if (is_frame && length >= 8) {
      info = checked_image_size(big_endian(bytes, found + 7, 2), big_endian(bytes, found + 5, 2), place);
    }
    // The first APP1 segment with EXIF data; others hold the same for editors (XMP).
    const std::string_view data = bytes.substr(found + 4, length - 2);
    if (code == 0xE1 && !has_exif && data.starts_with("Exif")) {
      has_exif = true;
      orientation = exif_orientation(data);
    }
    if (code == 0xDA) has_scan = true;
    offset = found + 2 + length;
  }
  if (!has_scan || info.width == 0) {
    throw InputError(place, "a JPEG with a frame and a scan", "a file without one");
  }
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
  if (pixels > kMaxJpegPixelsPerByte * bytes.size()) {
    throw InputError(place, fmt::format("rows of a {} x {} JPEG", info.width, info.height),
                     fmt::format("only {} bytes", bytes.size()));
  }
  info.orientation = orientation;
  return info;
}

}  // namespace penumbra::nn
