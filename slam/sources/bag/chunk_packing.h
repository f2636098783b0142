// How chunks of a recording are packed, and how they are unpacked. The libraries are optional: CMake finds
// them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

enum class Packing { none, lz4, bz2, zstd };

// "none" or "" (MCAP), "lz4", "bz2", "zstd"; throws InputError naming `place` for another.
Packing packing_named(std::string_view name, std::string_view place);

// What this build has of the optional libraries.
struct BagLibrary {
  const char* name;  // "lz4", "bz2", "zstd", "sqlite3"
  bool is_there;
};
std::vector<BagLibrary> bag_libraries();
// Throws InputError where this build cannot unpack it.
void require_packing(Packing packing, std::string_view place);

// More than any message has: a header that claims more is damaged or hostile.
inline constexpr std::size_t kLargestChunk = std::size_t{1} << 28;

// The `size` bytes that are packed in `packed`, at most kLargestChunk. lz4: its frame format, as ROS and MCAP
// use it; memory grows only as bytes come. Throws InputError naming `place` where they are others, and as
// require_packing does.
std::string unpack_chunk(std::string_view packed, Packing packing, std::size_t size, std::string_view place);

}  // namespace penumbra::slam
