#include "slam/dynamics/rgbd/box_cells.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

constexpr double kCellsInBox = 3200.0;

}  // namespace

void BoxCells::cut(const ByteView& image, const FloatImage& depth, const Rect& box, double ring_share) {
  side = std::max(1, static_cast<int>(std::lround(std::sqrt(box.area() / kCellsInBox))));
  const auto cells_of = [&](int length) {
    return std::max(2, static_cast<int>(std::lround(ring_share * length / side)));
  };
  ring = {cells_of(box.width), cells_of(box.height)};
  grid = {box.x - ring.width * side, box.y - ring.height * side,
          (box.width + side - 1) / side + 2 * ring.width, (box.height + side - 1) / side + 2 * ring.height};
  cells.assign(static_cast<std::size_t>(grid.area()), BoxCell{});
  const Rect whole{0, 0, depth.width(), depth.height()};
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Rect square{grid.x + column * side, grid.y + row * side, side, side};
      const Rect in_box = intersection(square, box);
      const Rect pixels = in_box.empty() ? intersection(square, whole) : in_box;
      if (pixels.empty()) continue;
      BoxCell& cell = cells[static_cast<std::size_t>(row * grid.width + column)];
      cell.place = in_box.empty() ? BoxCell::Place::ring : BoxCell::Place::box;
      // The pixel in the middle, or the first that has a depth.
      const int x = pixels.x + pixels.width / 2, y = pixels.y + pixels.height / 2;
      for (int c = 0; c < 3; ++c)
        cell.colour[static_cast<std::size_t>(c)] = image.at(x, y, image.channels == 3 ? c : 0);
      cell.depth = is_depth(depth.at(x, y)) ? depth.at(x, y) : 0.0F;
      for (int n = 0; n < pixels.area() && cell.depth == 0.0F; ++n) {
        const float z = depth.at(pixels.x + n % pixels.width, pixels.y + n / pixels.width);
        if (is_depth(z)) cell.depth = z;
      }
    }
  }
}

}  // namespace penumbra::slam
