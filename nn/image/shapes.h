// Shapes in masks (8 bits, one channel; 0 is outside): filled discs and polygons, what hangs together, how
// large it is.
#pragma once

#include <span>
#include <vector>

#include "nn/image/image.h"

namespace penumbra {

struct Pixel {
  int x = 0, y = 0;
  bool operator==(const Pixel&) const = default;
};

// The pixels of the disc of that radius, as the midpoint algorithm draws it; what lies outside the mask is
// left out. Cost: its pixels.
void fill_disc(ByteImage& mask, const Pixel& centre, int radius, std::uint8_t value);

// Numbers the parts of pixels that are not 0 and touch each other, corners included: 1, 2, ... in the order
// in which blocks of 2 x 2 pixels, row by row, first meet them; 0 is the rest. Returns how many parts there
// are. It joins runs, not pixels. Cost: a pass over the mask and one over the labels, 0.2 ms at 1241 x 376.
// Source: Rosenfeld and Pfaltz, Sequential operations in digital picture processing (1966), with a
// union-find.
int connected_components(const ByteView& mask, Image<std::int32_t>& labels);

// The corners of the smallest convex polygon around all points, in order, without those on its sides.
// Source: Andrew's monotone chain (1979). O(n log n).
std::vector<Pixel> convex_hull(std::vector<Pixel> points);

// The pixels whose centres a convex polygon holds, rounded to the nearest column at its sides, and those of
// lines drawn along its sides; what lies outside the mask is left out.
void fill_convex(ByteImage& mask, std::span<const Pixel> corners, std::uint8_t value);

// The smallest rectangle with all pixels that are not 0; empty where there are none.
Rect bounds_of(const ByteView& mask);
// Pixels that are not 0.
int count_pixels(const ByteView& mask);

}  // namespace penumbra
