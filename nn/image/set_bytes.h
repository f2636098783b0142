// Finds the bytes of a row that are not 0, where most are: eight at a time.
#pragma once

#include <cstdint>
#include <cstring>

namespace penumbra {

// The first of row[x], row[x + 1], ... below `width` that is not 0; `width` where all are.
inline int next_set_byte(const std::uint8_t* row, int x, int width) {
  std::uint64_t eight = 0;
  while (x + 8 <= width && (std::memcpy(&eight, row + x, 8), eight == 0)) x += 8;
  while (x < width && row[x] == 0) ++x;
  return x;
}

}  // namespace penumbra
