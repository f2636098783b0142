// Where the robot believes to be: the position model of docs/papers.md, D.1, as the mapping uses it.
//
//   speed, turn rate -> head-direction ring -> oscillators of every module -> grid cells
//
// The oscillators integrate the path exactly, and a position is read off the phases of the first module by
// least squares. The grid cells are what is compared: with place cells (place_cells.h) and from node to node.
// A familiar template pulls all phases to its place by reset().
//
// Cost of move(): 9 us for 10 modules of 25 cells; it allocates nothing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/brain/position/grid_code.h"
#include "slam/brain/position/head_direction_ring.h"

namespace penumbra::slam::brain {

// What a drive needs: the shortest wavelength and how much each next one is longer, metres.
struct PositionModelSettings {
  double first_wavelength = 4.0;
  double wavelength_ratio = 1.4142135623730951;
};

class PositionModel {
 public:
  // At the origin, heading along x.
  explicit PositionModel(const GridCode& code, const PositionModelSettings& settings = {});

  // By odometry: the heading turns by turn_rate * seconds, half of it before the way and half after it, so
  // that circles close. m/s, rad/s, s. Turns are counter-clockwise from x to y.
  void move(double speed, double turn_rate, double seconds);
  // Metres, and radians in (-pi, pi].
  void reset(const Eigen::Vector2d& position, double heading);

  Eigen::Vector2d position() const { return oscillators_.front().position(); }
  double heading() const { return ring_.heading(); }
  // The activity of all grid cells here, in [0, 1]; valid until the next call of a function that is not
  // const.
  std::span<const float> activity() const { return reader_.activity(); }
  // The activity that there would be elsewhere; valid until the next call of it.
  std::span<const float> activity_at(const Eigen::Vector2d& position);
  const GridCode& code() const { return reader_.code(); }

 private:
  HeadDirectionRing ring_;
  GridCodeReader reader_, elsewhere_;
  std::vector<Oscillators> oscillators_;
};

// The code that ships: ten modules of 25 cells, trained for 1000 s in the square room with seed 1. It is
// trained when it is first asked for, in 0.3 s; weights_tools/models/penumbra-grid.safetensors is the same.
const GridCode& standard_grid_code();

}  // namespace penumbra::slam::brain
