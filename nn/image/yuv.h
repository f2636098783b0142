// Blue, green and red of a pixel that is given as brightness Y and two colour differences U and V.
//
//   blue  = k (Y - black) + b_u (U - 128)
//   green = k (Y - black) - g_v (V - 128) - g_u (U - 128)       k (Y - black) at least 0
//   red   = k (Y - black) + r_v (V - 128)                       ITU-R BT.601
//
//   range           black   k       b_u     g_u     g_v     r_v
//   video (16-235)  16      1.164   2.018   0.391   0.813   1.596     as USB cameras mean it
//   full (0-255)    0       1       1.772   0.344   0.714   1.402     as JPEG has it
//
// Error against real arithmetic: 1 level. Cost: about 2 ns.
#pragma once

#include <algorithm>
#include <cstdint>

namespace penumbra {

// Factors of 16 bits after the point.
struct YuvRange {
  int black, brightness, blue_u, green_u, green_v, red_v;
};
inline constexpr YuvRange kVideoRange = {16, 76309, 132201, 25675, 53279, 104597};
inline constexpr YuvRange kFullRange = {0, 65536, 116130, 22554, 46802, 91881};

inline void put_bgr(const YuvRange& range, int y, int u, int v, std::uint8_t* bgr) {
  constexpr int kBits = 16, kHalf = 1 << (kBits - 1);
  const auto level = [](int value) { return static_cast<std::uint8_t>(std::clamp(value >> kBits, 0, 255)); };
  const int bright = range.brightness * std::max(0, y - range.black) + kHalf;
  u -= 128;
  v -= 128;
  bgr[0] = level(bright + range.blue_u * u);
  bgr[1] = level(bright - range.green_u * u - range.green_v * v);
  bgr[2] = level(bright + range.red_v * v);
}

}  // namespace penumbra
