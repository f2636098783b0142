#include "tests/fuzz/repair.h"

#include <cstdint>
#include <span>

#include "nn/base/crc32.h"

namespace penumbra::fuzz {

namespace {

// The `size` bytes at `offset`, which must lie in `bytes`, as a little-endian number.
std::uint64_t number_at(std::string_view bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[offset + i]);
  return value;
}

}  // namespace

std::string repair_png(std::string_view bytes) {
  constexpr std::size_t kSignature = 8, kFrame = 12;  // a chunk: length, type, data, CRC; all big-endian
  std::string repaired(bytes);
  for (std::size_t offset = kSignature; offset + kFrame <= bytes.size();) {
    const std::size_t length = __builtin_bswap32(static_cast<std::uint32_t>(number_at(bytes, offset, 4)));
    if (length > bytes.size() - offset - kFrame) break;
    const std::uint32_t crc = nn::crc32(bytes.substr(offset + 4, 4 + length));
    for (std::size_t i = 0; i < 4; ++i) {
      repaired[offset + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    }
    offset += kFrame + length;
  }
  return repaired;
}

std::string repair_map(std::string_view bytes) {
  constexpr std::size_t kCrc = 12, kSize = 16, kBody = 24;
  std::string repaired(bytes);
  if (bytes.size() < kBody) return repaired;
  const std::uint64_t crc = nn::crc32(bytes.substr(kBody)), size = bytes.size() - kBody;
  for (std::size_t i = 0; i < 4; ++i) repaired[kCrc + i] = static_cast<char>(crc >> (8 * i));
  for (std::size_t i = 0; i < 8; ++i) repaired[kSize + i] = static_cast<char>(size >> (8 * i));
  return repaired;
}

std::string repair_zip(std::string_view bytes) {
  // Offsets in an entry of the central directory, and in an entry's own header.
  constexpr std::size_t kMethod = 10, kCrc = 16, kSize = 20, kHeaderOffset = 42, kDirectoryEntry = 46;
  constexpr std::size_t kOwnCrc = 14, kNameLength = 26, kExtraLength = 28, kOwnHeader = 30;
  std::string repaired(bytes);
  for (std::size_t entry = bytes.find("PK\1\2"); entry != std::string_view::npos;
       entry = bytes.find("PK\1\2", entry + 4)) {
    if (bytes.size() - entry < kDirectoryEntry) break;
    if (number_at(bytes, entry + kMethod, 2) != 0) continue;
    const std::uint64_t header = number_at(bytes, entry + kHeaderOffset, 4);
    if (header + kOwnHeader > bytes.size()) continue;
    const std::uint64_t begin = header + kOwnHeader + number_at(bytes, header + kNameLength, 2) +
                                number_at(bytes, header + kExtraLength, 2);
    const std::uint64_t size = number_at(bytes, entry + kSize, 4);
    if (begin > bytes.size() || size > bytes.size() - begin) continue;
    const std::uint32_t crc = nn::crc32(bytes.substr(begin, size));
    for (std::size_t i = 0; i < 4; ++i) {
      repaired[entry + kCrc + i] = static_cast<char>(crc >> (8 * i));
      repaired[header + kOwnCrc + i] = static_cast<char>(crc >> (8 * i));
    }
  }
  return repaired;
}

}  // namespace penumbra::fuzz
