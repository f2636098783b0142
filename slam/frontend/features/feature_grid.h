// Finds the features near a pixel: they are sorted into square cells of the image, of 16 pixels, or more
// where a huge image has few features: the cells never cost more than 64 times what the features do.
//
// Cost: build O(n); a query touches the cells under its square only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "slam/frontend/features/feature.h"

namespace penumbra::slam {

class FeatureGrid {
 public:
  FeatureGrid() = default;
  // `width`, `height`: size of the image in pixels.
  FeatureGrid(const std::vector<Keypoint>& keypoints, int width, int height);

  // Calls visit(i), or visit(i, level), for every feature i with |u_i - u| <= radius and |v_i - v| <= radius,
  // pixels. A position that is outside the image or not finite finds what its square covers, perhaps nothing.
  template <typename Visit>
  void visit_near(float u, float v, float radius, Visit&& visit) const {
    visit_rows(
        u, v, radius, [](float, float) { return std::pair(-kEverywhere, kEverywhere); }, visit);
  }
  // The same without most of what is farther than `margin` from the line a u + b v + c = 0, pixels.
  template <typename Visit>
  void visit_near_line(float u, float v, float radius, const std::array<float, 3>& line, float margin,
                       Visit&& visit) const;

 private:
  static constexpr float kSmallestCell = 16.0F;  // pixels
  static constexpr int kLevelBits = 8;
  static constexpr float kEverywhere = 1e9F;  // pixels

  template <typename Columns, typename Visit>
  void visit_rows(float u, float v, float radius, Columns&& columns_of, Visit&& visit) const;
  int column(float u) const { return std::clamp(static_cast<int>(u / cell_size_), 0, columns_ - 1); }
  int row(float v) const { return std::clamp(static_cast<int>(v / cell_size_), 0, rows_ - 1); }

  struct Entry {
    float u, v;
    std::uint32_t feature_and_level;  // the level in the lowest kLevelBits
  };
  float width_ = 0.0F, height_ = 0.0F, cell_size_ = kSmallestCell;
  int columns_ = 0, rows_ = 0;
  std::vector<int> begin_;  // cell -> its first entry; one more at the end
  std::vector<Entry> entries_;
};

template <typename Visit>
void FeatureGrid::visit_near_line(float u, float v, float radius, const std::array<float, 3>& line,
                                  float margin, Visit&& visit) const {
  const float a = line[0], b = line[1], c = line[2];
  const float length = std::hypot(a, b);
  // A line that is a row, or none.
  if (!(std::abs(a) > 1e-4F * length)) {
    visit_near(u, v, radius, visit);
    return;
  }
  const float reach = margin * length / std::abs(a);  // to the left and right of the line
  const auto columns_of = [&](float top, float bottom) {
    const float at_top = -(b * top + c) / a, at_bottom = -(b * bottom + c) / a;
    return std::pair(std::min(at_top, at_bottom) - reach, std::max(at_top, at_bottom) + reach);
  };
  visit_rows(u, v, radius, columns_of, visit);
}

// `columns_of`: from where to where, in u, a row of cells from v = top to bottom is looked at.
template <typename Columns, typename Visit>
void FeatureGrid::visit_rows(float u, float v, float radius, Columns&& columns_of, Visit&& visit) const {
  // Also false for what is not a number.
  const bool overlaps =
      u + radius >= 0.0F && v + radius >= 0.0F && u - radius <= width_ && v - radius <= height_;
  if (!overlaps || entries_.empty()) return;
  const float left = std::max(u - radius, 0.0F), right = std::min(u + radius, width_);
  const int first_row = row(std::max(v - radius, 0.0F)), last_row = row(std::min(v + radius, height_));
  for (int r = first_row; r <= last_row; ++r) {
    const auto [from, to] =
        columns_of(static_cast<float>(r) * cell_size_, static_cast<float>(r + 1) * cell_size_);
    if (!(from <= right && to >= left)) continue;
    const int first_column = column(std::max(from, left)), last_column = column(std::min(to, right));
    const int begin = begin_[static_cast<std::size_t>(r * columns_ + first_column)];
    const int end = begin_[static_cast<std::size_t>(r * columns_ + last_column + 1)];
    for (int i = begin; i < end; ++i) {
      const Entry& entry = entries_[static_cast<std::size_t>(i)];
      if (!(std::abs(entry.u - u) <= radius && std::abs(entry.v - v) <= radius)) continue;
      const int feature = static_cast<int>(entry.feature_and_level >> kLevelBits);
      if constexpr (std::is_invocable_v<Visit, int, int>) {
        visit(feature, static_cast<int>(entry.feature_and_level & ((1U << kLevelBits) - 1U)));
      } else {
        visit(feature);
      }
    }
  }
}

}  // namespace penumbra::slam
