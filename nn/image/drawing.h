// Draws on images: lines, discs, boxes and text, with smooth edges.
//
//   picture = (1 - c) picture + c colour,   c = clamp(1/2 - d, 0, 1)
//
// d is the distance (pixels) of the pixel's centre from the shape's outline, negative inside; where the parts
// of one shape overlap, the largest c counts. Pixel (x, y) has its centre at (x, y). Text is drawn with
// strokes (stroke_font.h); what is not ASCII is drawn as '?'.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "nn/image/image.h"

namespace penumbra {

struct Point2 {
  double x = 0.0, y = 0.0;
};

using Bgr = std::array<std::uint8_t, 3>;  // blue, green, red

// All take BGR pictures; what lies outside of them is left out. `width`, `radius` and `height` in pixels.
void draw_polyline(ByteImage& picture, std::span<const Point2> points, double width, const Bgr& colour);
void draw_line(ByteImage& picture, Point2 a, Point2 b, double width, const Bgr& colour);
void draw_disc(ByteImage& picture, Point2 centre, double radius, const Bgr& colour);
// The rectangle between two corners, filled or (where `width` > 0) its outline.
void draw_box(ByteImage& picture, Point2 low, Point2 high, const Bgr& colour, double width = 0.0);

// `height`: of a capital; `origin`: where the baseline begins.
void draw_text(ByteImage& picture, std::string_view text, Point2 origin, double height, const Bgr& colour,
               bool bold = false);
double text_width(std::string_view text, double height);

}  // namespace penumbra
