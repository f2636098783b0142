// Place cells: each keeps the grid code's activity at its place, and they compete for the position.
//
//   p_i = exp( -|| a - a_i ||^2 / (2 sigma^2) )        (8);  sigma = width sqrt(grid cells)
//
// a is the activity of all grid cells, a_i that at the place of cell i. The cell with the largest p wins and
// its place is the position. A place at which no cell is active enough gets a cell of its own: visit().
//
// Cost: grid cells x place cells multiplications to find the winner: 2 ms for 75 and 40,000; it allocates
// nothing.
// Source: Chen et al. (docs/papers.md, D.1). Open there, and chosen here: sigma, and when a cell is added.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "slam/brain/position/grid_code.h"

namespace penumbra::slam::brain {

struct PlaceCellSettings {
  double width = 0.25;    // root mean square difference of a grid cell's activity at which p = 0.61
  double familiar = 0.5;  // of the winner's p: below, visit() adds a cell
};

class PlaceCells {
 public:
  struct Winner {
    std::size_t cell = 0;
    double activity = 0.0;  // p
    Eigen::Vector2d place;  // metres
  };

  explicit PlaceCells(int grid_cells, const PlaceCellSettings& settings = {});
  // A cell every `step` metres on the square of 2 half x 2 half metres round `centre`.
  static PlaceCells on_square(const GridCode& code, const Eigen::Vector2d& centre, double half, double step,
                              const PlaceCellSettings& settings = {});

  std::size_t size() const { return places_.size(); }
  std::size_t add(std::span<const float> grid, const Eigen::Vector2d& place);  // the new cell's number
  // The winner, or a new cell where there is none that is active enough.
  Winner visit(std::span<const float> grid, const Eigen::Vector2d& place);
  // Of equal ones the first. InputError where there is no cell.
  Winner winner(std::span<const float> grid) const;
  double activity(std::size_t cell, std::span<const float> grid) const;  // p
  const Eigen::Vector2d& place(std::size_t cell) const { return places_[cell]; }

 private:
  Eigen::Map<const Eigen::VectorXf> kept(std::size_t cell) const;  // a_i

  PlaceCellSettings settings_;
  std::size_t grid_cells_;
  std::vector<float> activities_;    // a_i side by side
  std::vector<float> half_squares_;  // || a_i ||^2 / 2
  std::vector<Eigen::Vector2d> places_;
};

}  // namespace penumbra::slam::brain
