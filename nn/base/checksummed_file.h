// Files of our own formats: a magic, a version, and a body whose size and checksum the header names, so that
// torn and damaged files are found before anything in them is believed.
//
//   magic (8 bytes)  version u32  CRC-32 of the body u32  bytes of the body u64  | body
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace penumbra::nn {

inline constexpr std::size_t kChecksummedHeaderBytes = 8 + 4 + 4 + 8;

// Writes the whole file or none. Throws Error where that fails.
void write_checksummed_file(const std::filesystem::path& path, std::string_view magic, std::uint32_t version,
                            std::string_view body);

// The body. `what` names what is expected, such as "a map that Penumbra saved". Throws InputError naming the
// file where it cannot be read, begins differently, is of another version, torn or damaged.
std::string read_checksummed_file(const std::filesystem::path& path, std::string_view magic,
                                  std::uint32_t version, std::string_view what);

}  // namespace penumbra::nn
