#include "nn/evaluation/polygon_raster.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace penumbra::nn {

namespace {

constexpr int kScale = 5;
constexpr int kLeftOfMiddle = 2;  // grid columns 5k + 2 and 5k + 3 lie about the middle of pixel column k

struct GridPoint {
  std::int64_t x = 0, y = 0;
};

// Truncation, not floor, left of and above the image: the reference casts to int. It matters for the slopes.
std::int64_t truncated(double value) { return static_cast<std::int64_t>(value); }

GridPoint to_grid(double x, double y) { return {truncated(kScale * x + 0.5), truncated(kScale * y + 0.5)}; }

// An edge, turned so that its longer side is walked in the direction of growing coordinates.
class Edge {
 public:
  Edge(GridPoint from, GridPoint to) {
    const std::int64_t width = std::abs(to.x - from.x), height = std::abs(to.y - from.y);
    is_wide_ = width >= height;
    if (is_wide_ ? from.x > to.x : from.y > to.y) std::swap(from, to);
    start_ = from;
    end_ = to;
    steps_ = is_wide_ ? width : height;
    const auto rise = static_cast<double>(is_wide_ ? to.y - from.y : to.x - from.x);
    slope_ = steps_ > 0 ? rise / static_cast<double>(steps_) : 0.0;
  }

  std::int64_t left() const { return std::min(start_.x, end_.x); }
  std::int64_t right() const { return std::max(start_.x, end_.x); }

  // The smaller grid row of the step between grid columns x and x + 1, both within the edge.
  std::int64_t crossing_row(std::int64_t x) const {
    if (is_wide_) {
      const std::int64_t step = x - start_.x;
      return std::min(beside(start_.y, step), beside(start_.y, step + 1));
    }
    // The first step on the other side, from the straight line's own; rounding can put it one off.
    const bool rightwards = slope_ > 0.0;
    const auto is_beyond = [&](std::int64_t step) {
      const std::int64_t column = beside(start_.x, step);
      return rightwards ? column > x : column <= x;
    };
    const double guess = (static_cast<double>(x) + 0.5 - static_cast<double>(start_.x)) / slope_;
    std::int64_t step = std::clamp<std::int64_t>(truncated(guess), 1, steps_);
    while (step < steps_ && !is_beyond(step)) ++step;
    while (step > 1 && is_beyond(step - 1)) --step;
    return start_.y + step - 1;
  }

 private:
  // The coordinate across the longer side after `step` steps.
  std::int64_t beside(std::int64_t start, std::int64_t step) const {
    return truncated(static_cast<double>(start) + slope_ * static_cast<double>(step) + 0.5);
  }

  GridPoint start_, end_;
  std::int64_t steps_ = 0;
  double slope_ = 0.0;  // across per step, -1..1
  bool is_wide_ = false;
};

// Appends the pixel numbers at which the edge crosses the image's columns.
void append_crossings(const Edge& edge, int width, int height, std::vector<std::uint32_t>& crossings) {
  if (edge.right() <= kLeftOfMiddle) return;
  // Columns k with left <= 5k + 2 and 5k + 3 <= right.
  const std::int64_t first = std::max<std::int64_t>(0, (edge.left() - kLeftOfMiddle + kScale - 1) / kScale);
  const std::int64_t last = std::min<std::int64_t>(width - 1, (edge.right() - kLeftOfMiddle - 1) / kScale);
  for (std::int64_t column = first; column <= last; ++column) {
    const auto grid_row = static_cast<double>(edge.crossing_row(column * kScale + kLeftOfMiddle));
    const double row =
        std::ceil(std::clamp((grid_row + 0.5) / kScale - 0.5, 0.0, static_cast<double>(height)));
    crossings.push_back(static_cast<std::uint32_t>(column * height) + static_cast<std::uint32_t>(row));
  }
}

}  // namespace

RunMask rasterise_polygon(std::span<const double> xy, int width, int height) {
  std::vector<std::uint32_t> crossings;
  const std::size_t vertices = xy.size() / 2;
  for (std::size_t i = 0; i < vertices; ++i) {
    const std::size_t next = i + 1 < vertices ? i + 1 : 0;
    const Edge edge(to_grid(xy[2 * i], xy[2 * i + 1]), to_grid(xy[2 * next], xy[2 * next + 1]));
    append_crossings(edge, width, height, crossings);
  }
  std::sort(crossings.begin(), crossings.end());
  // An outline that is closed crosses every column an even number of times.
  std::vector<std::uint32_t> counts;
  counts.reserve(crossings.size() + 1);
  std::uint32_t begin = 0;
  for (const std::uint32_t crossing : crossings) {
    counts.push_back(crossing - begin);
    begin = crossing;
  }
  return mask_from_counts(counts, width, height);
}

RunMask rasterise_polygons(const std::vector<std::vector<double>>& polygons, int width, int height) {
  std::vector<RunMask> parts;
  parts.reserve(polygons.size());
  for (const std::vector<double>& polygon : polygons) {
    parts.push_back(rasterise_polygon(polygon, width, height));
  }
  return mask_union(parts, width, height);
}

}  // namespace penumbra::nn
