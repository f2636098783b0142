#include "nn/image/bayer.h"

#include "nn/image/border.h"

namespace penumbra {

ByteImage demosaic(const ByteView& mosaic, BayerPattern pattern) {
  // Where red stands in the mosaic's 2 x 2 pixels; blue is across from it.
  const int red_x = pattern == BayerPattern::rggb || pattern == BayerPattern::gbrg ? 0 : 1;
  const int red_y = pattern == BayerPattern::rggb || pattern == BayerPattern::grbg ? 0 : 1;
  ByteImage bgr(mosaic.width, mosaic.height, 3);
  for (int y = 0; y < mosaic.height; ++y) {
    const std::uint8_t* above = mosaic.row(mirrored(y - 1, mosaic.height));
    const std::uint8_t* here = mosaic.row(y);
    const std::uint8_t* below = mosaic.row(mirrored(y + 1, mosaic.height));
    std::uint8_t* out = bgr.row(y);
    const bool is_red_row = y % 2 == red_y;
    for (int x = 0; x < mosaic.width; ++x, out += 3) {
      const int l = mirrored(x - 1, mosaic.width), r = mirrored(x + 1, mosaic.width);
      const int across = (here[l] + here[r] + 1) >> 1, along = (above[x] + below[x] + 1) >> 1;
      const bool is_red_column = x % 2 == red_x;
      if (is_red_row == is_red_column) {
        // Red or blue: green lies beside, the other colour at the corners.
        const int green = (here[l] + here[r] + above[x] + below[x] + 2) >> 2;
        const int corners = (above[l] + above[r] + below[l] + below[r] + 2) >> 2;
        out[is_red_row ? 2 : 0] = here[x];
        out[1] = static_cast<std::uint8_t>(green);
        out[is_red_row ? 0 : 2] = static_cast<std::uint8_t>(corners);
      } else {
        out[1] = here[x];
        out[is_red_row ? 2 : 0] = static_cast<std::uint8_t>(across);
        out[is_red_row ? 0 : 2] = static_cast<std::uint8_t>(along);
      }
    }
  }
  return bgr;
}

}  // namespace penumbra
