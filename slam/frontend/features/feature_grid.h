// Finds the features near a pixel: they are sorted into square cells of the image, of 16 pixels, or more
// where a huge image has few features: the cells never cost more than 64 times what the features do.
//
// Cost: build O(n); a query touches the cells under its square only.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/frontend/features/feature.h"

namespace penumbra::slam {

class FeatureGrid {
 public:
  FeatureGrid() = default;
  // `width`, `height`: size of the image in pixels.
  FeatureGrid(const std::vector<Keypoint>& keypoints, int width, int height);

  // Calls visit(i) for every feature i with |u_i - u| <= radius and |v_i - v| <= radius, pixels. A position
  // that is outside the image or not finite finds what its square covers, perhaps nothing.
  template <typename Visit>
  void visit_near(float u, float v, float radius, Visit&& visit) const;

 private:
  static constexpr float kSmallestCell = 16.0F;  // pixels

  int column(float u) const { return std::clamp(static_cast<int>(u / cell_size_), 0, columns_ - 1); }
  int row(float v) const { return std::clamp(static_cast<int>(v / cell_size_), 0, rows_ - 1); }

  struct Entry {
    float u, v;
    int feature;
  };
  float width_ = 0.0F, height_ = 0.0F, cell_size_ = kSmallestCell;
  int columns_ = 0, rows_ = 0;
  std::vector<int> begin_;  // cell -> its first entry; one more at the end
  std::vector<Entry> entries_;
};

template <typename Visit>
void FeatureGrid::visit_near(float u, float v, float radius, Visit&& visit) const {
  // Also false for what is not a number.
  const bool overlaps =
      u + radius >= 0.0F && v + radius >= 0.0F && u - radius <= width_ && v - radius <= height_;
  if (!overlaps || entries_.empty()) return;
  const int first_column = column(std::max(u - radius, 0.0F)),
            last_column = column(std::min(u + radius, width_));
  const int first_row = row(std::max(v - radius, 0.0F)), last_row = row(std::min(v + radius, height_));
  for (int r = first_row; r <= last_row; ++r) {
    const int begin = begin_[static_cast<std::size_t>(r * columns_ + first_column)];
    const int end = begin_[static_cast<std::size_t>(r * columns_ + last_column + 1)];
    for (int i = begin; i < end; ++i) {
      const Entry& entry = entries_[static_cast<std::size_t>(i)];
      if (std::abs(entry.u - u) <= radius && std::abs(entry.v - v) <= radius) visit(entry.feature);
    }
  }
}

}  // namespace penumbra::slam
