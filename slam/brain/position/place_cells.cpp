#include "slam/brain/position/place_cells.h"

#include <cmath>

#include "nn/base/error.h"

namespace penumbra::slam::brain {

namespace {

Eigen::Map<const Eigen::VectorXf> as_vector(std::span<const float> grid) {
  return {grid.data(), static_cast<Eigen::Index>(grid.size())};
}

}  // namespace

PlaceCells::PlaceCells(int grid_cells, const PlaceCellSettings& settings)
    : settings_(settings), grid_cells_(static_cast<std::size_t>(grid_cells)) {}

PlaceCells PlaceCells::on_square(const GridCode& code, const Eigen::Vector2d& centre, double half,
                                 double step, const PlaceCellSettings& settings) {
  PlaceCells cells(code.cells(), settings);
  GridCodeReader reader(code);
  const int side = static_cast<int>(std::floor(2.0 * half / step + 1e-9)) + 1;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const Eigen::Vector2d place = centre + Eigen::Vector2d(column * step - half, row * step - half);
      cells.add(reader.at(place), place);
    }
  }
  return cells;
}

Eigen::Map<const Eigen::VectorXf> PlaceCells::kept(std::size_t cell) const {
  return as_vector({activities_.data() + cell * grid_cells_, grid_cells_});
}

std::size_t PlaceCells::add(std::span<const float> grid, const Eigen::Vector2d& place) {
  activities_.insert(activities_.end(), grid.begin(), grid.end());
  half_squares_.push_back(0.5F * as_vector(grid).squaredNorm());
  places_.push_back(place);
  return places_.size() - 1;
}

PlaceCells::Winner PlaceCells::visit(std::span<const float> grid, const Eigen::Vector2d& place) {
  if (size() > 0) {
    const Winner best = winner(grid);
    if (best.activity >= settings_.familiar) return best;
  }
  return {add(grid, place), 1.0, place};
}

PlaceCells::Winner PlaceCells::winner(std::span<const float> grid) const {
  if (places_.empty()) throw InputError("place cells", "at least one", "none");
  const auto given = as_vector(grid);
  // || a - a_i ||^2 / 2 without || a ||^2 / 2, which is the same for all
  const auto distance = [&](std::size_t cell) { return half_squares_[cell] - kept(cell).dot(given); };
  std::size_t nearest = 0;
  float least = distance(0);
  for (std::size_t cell = 1; cell < size(); ++cell) {
    if (const float here = distance(cell); here < least) {
      least = here;
      nearest = cell;
    }
  }
  return {nearest, activity(nearest, grid), places_[nearest]};
}

double PlaceCells::activity(std::size_t cell, std::span<const float> grid) const {
  const double squared = static_cast<double>((as_vector(grid) - kept(cell)).squaredNorm());
  const double variance = settings_.width * settings_.width * static_cast<double>(grid_cells_);
  return std::exp(-squared / (2.0 * variance));
}

}  // namespace penumbra::slam::brain
