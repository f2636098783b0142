// Boxes in pixels: corners (x1, y1) upper left and (x2, y2) lower right, x2 >= x1, y2 >= y1. Areas and
// overlaps treat them as continuous rectangles (no "+ 1").
#pragma once

#include <algorithm>

namespace penumbra::nn {

struct Box {
  float x1 = 0.0F, y1 = 0.0F, x2 = 0.0F, y2 = 0.0F;

  float width() const { return x2 - x1; }
  float height() const { return y2 - y1; }
  float area() const { return width() * height(); }
};

// Intersection over union, 0..1; 0 where both areas are 0.
inline float iou(const Box& a, const Box& b) {
  const float width = std::max(std::min(a.x2, b.x2) - std::max(a.x1, b.x1), 0.0F);
  const float height = std::max(std::min(a.y2, b.y2) - std::max(a.y1, b.y1), 0.0F);
  const float intersection = width * height;
  const float all = a.area() + b.area() - intersection;
  return all > 0.0F ? intersection / all : 0.0F;
}

// The part of the box inside an image of width x height pixels.
inline Box clip(const Box& box, float width, float height) {
  return {std::clamp(box.x1, 0.0F, width), std::clamp(box.y1, 0.0F, height), std::clamp(box.x2, 0.0F, width),
          std::clamp(box.y2, 0.0F, height)};
}

}  // namespace penumbra::nn
