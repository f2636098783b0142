// CRC-32 of zlib, PNG and zip files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace penumbra::test {

// `crc` continues an earlier one.
inline std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> entries{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      entries[i] = i;
      for (int bit = 0; bit < 8; ++bit) entries[i] = (entries[i] >> 1) ^ (entries[i] & 1U ? 0xEDB88320U : 0U);
    }
    return entries;
  }();
  crc = ~crc;
  for (const std::byte byte : bytes)
    crc = (crc >> 8) ^ table[(crc ^ static_cast<std::uint32_t>(byte)) & 0xFFU];
  return ~crc;
}

}  // namespace penumbra::test
