// nn::crc32 over a tensor's bytes.
#pragma once

#include <cstddef>
#include <span>

#include "nn/base/crc32.h"

namespace penumbra::test {

// `crc` continues an earlier one.
inline std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0) {
  return nn::crc32({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, crc);
}

}  // namespace penumbra::test
