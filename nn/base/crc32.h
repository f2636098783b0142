// CRC-32 as in PNG, zip and zlib (polynomial 0xEDB88320, reflected): finds torn and damaged files.
//
// Cost: about 0.1 ns a byte. It protects against accidents, not against an attacker.
#pragma once

#include <cstdint>
#include <string_view>

namespace penumbra::nn {

// `crc` continues the sum of what came before.
std::uint32_t crc32(std::string_view bytes, std::uint32_t crc = 0);

}  // namespace penumbra::nn
