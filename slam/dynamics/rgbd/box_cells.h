// A detector's box and a ring around it, cut into small squares of pixels (cells), some 3200 of them in the
// box whatever its size.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "nn/image/image.h"

namespace penumbra::slam {

inline bool is_depth(float metres) { return metres > 0.0F && std::isfinite(metres); }

struct BoxCell {
  enum class Place : std::uint8_t { outside, ring, box };  // outside: of the image

  float depth = 0.0F;  // metres; 0: unknown
  std::array<std::uint8_t, 3> colour{};
  Place place = Place::outside;
  std::int8_t cluster = -1;
  bool is_object = false;
};

struct BoxCells {
  int side = 1;  // pixels of a cell
  Size ring;     // cells, on each side of the box
  Rect grid;     // x, y: pixel where the cells begin; size in cells
  std::vector<BoxCell> cells;

  // The cells of a box inside the image, with depth and colour. `ring_share`: of the box's sides.
  void cut(const ByteView& image, const FloatImage& depth, const Rect& box, double ring_share);
};

}  // namespace penumbra::slam
