#include "slam/map/dense/dense_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nn/base/ceil_div.h"
#include "nn/base/parallel.h"

namespace penumbra::slam {

namespace {

// The depth of a pixel, 0 where it has none or stands at a jump.
float steady_depth(const FloatImage& depth, int column, int row, const DepthCoding& coding) {
  const float z = depth.at(column, row);
  if (!(z > 0.0F)) return 0.0F;
  for (int y = std::max(0, row - 1); y <= std::min(depth.height() - 1, row + 1); ++y) {
    for (int x = std::max(0, column - 1); x <= std::min(depth.width() - 1, column + 1); ++x) {
      const float other = depth.at(x, y);
      const float change = std::abs(other - z);
      if (other > 0.0F && change > coding.jump * z && change > coding.least_jump * z * other) return 0.0F;
    }
  }
  return z;
}

}  // namespace

DenseView make_dense_view(const StereoCamera& camera, const ByteImage& image, const FloatImage& depth,
                          int step, const DepthCoding& coding) {
  const int width = ceil_div(depth.width(), step), height = ceil_div(depth.height(), step);
  DenseView view;
  view.camera = camera;
  view.step = step;
  view.depth_units = coding.units;
  view.camera.fx /= step;
  view.camera.fy /= step;
  view.camera.cx /= step;
  view.camera.cy /= step;
  view.camera.width = width;
  view.camera.height = height;
  view.depth.create(width, height);
  view.colour.create(width, height, 3);
  view.label.create(width, height);
  const bool grey = image.channels() == 1;
  for (int y = 0; y < height; ++y) {
    std::uint16_t* const depths = view.depth.row(y);
    std::uint8_t* const colours = view.colour.row(y);
    std::uint8_t* const labels = view.label.row(y);
    const std::uint8_t* const from = image.row(y * step);
    for (int x = 0; x < width; ++x) {
      const float z = steady_depth(depth, x * step, y * step, coding);
      depths[x] = static_cast<std::uint16_t>(std::lround(std::min(z * coding.units, 65535.0F)));
      labels[x] = 0;
      for (int c = 0; c < 3; ++c) colours[3 * x + c] = grey ? from[x * step] : from[3 * x * step + c];
    }
  }
  return view;
}

void correct_disparity_offset(DenseView& view, double offset) {
  const double change = (view.camera.disparity_offset - offset) / (view.camera.fx * view.camera.baseline);
  view.camera.disparity_offset = offset;
  if (change == 0.0) return;
  const double per_unit = change / view.depth_units;  // of 1 / z for each unit
  std::uint16_t* const depths = view.depth.data();
  for (std::size_t i = 0; i < view.depth.elements(); ++i) {
    const double stretch = 1.0 + depths[i] * per_unit;
    depths[i] = stretch <= 0.0
                    ? std::uint16_t{65535}
                    : static_cast<std::uint16_t>(std::lround(std::min(depths[i] / stretch, 65535.0)));
  }
}

float nearest_depth(const DenseView& view, int column, int row) {
  constexpr int kFewest = 5;
  const bool inside =
      column > 0 && row > 0 && column < view.depth.width() - 1 && row < view.depth.height() - 1;
  if (!inside || view.depth.at(column, row) == 0) return 0.0F;
  int least = std::numeric_limits<std::uint16_t>::max(), known = 0;
  for (int y = row - 1; y <= row + 1; ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      const int depth = view.depth.at(x, y);
      if (depth == 0) continue;
      ++known;
      least = std::min(least, depth);
    }
  }
  return known >= kFewest ? static_cast<float>(least) / view.depth_units : 0.0F;
}

FloatImage nearest_depths(const DenseView& view) {
  FloatImage nearest(view.depth.width(), view.depth.height());
  parallel_for(nearest.height(), 8, [&](int row) {
    for (int column = 0; column < nearest.width(); ++column)
      nearest.at(column, row) = nearest_depth(view, column, row);
  });
  return nearest;
}

void set_label(DenseView& view, const Rect& region, const ByteImage& mask, std::uint8_t label, int grow) {
  if (mask.empty() || region.width <= 0 || region.height <= 0) return;
  const int step = view.step, reach = ceil_div(grow, step);
  const auto on_mask = [&](int column, int row) {  // of the small image
    const int x = column * step - region.x, y = row * step - region.y;
    if (x < 0 || y < 0 || x >= region.width || y >= region.height) return false;
    return mask.at(x * mask.width() / region.width, y * mask.height() / region.height) != 0;
  };
  const Rect image{0, 0, view.label.width(), view.label.height()};
  const auto mark_around = [&](int column, int row) {
    const Rect around = intersection({column - reach, row - reach, 2 * reach + 1, 2 * reach + 1}, image);
    for (int y = around.y; y < around.y + around.height; ++y) {
      for (int x = around.x; x < around.x + around.width; ++x) {
        std::uint8_t& there = view.label.at(x, y);
        if (there != kMoves) there = label;
      }
    }
  };
  const Rect small = intersection(
      {region.x / step, region.y / step, region.width / step + 2, region.height / step + 2}, image);
  for (int row = small.y; row < small.y + small.height; ++row) {
    for (int column = small.x; column < small.x + small.width; ++column) {
      if (on_mask(column, row)) mark_around(column, row);
    }
  }
}

}  // namespace penumbra::slam
