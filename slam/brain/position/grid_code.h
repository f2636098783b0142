// The grid code of a place: several modules of grid cells, each with a spatial scale of its own.
//
//   wavelength_m = wavelength_0 ratio^m
//   activity(x)  = ( f(q_0 chi_0(x)), f(q_1 chi_1(x)), ... )         one vector of all cells of all modules
//
// The rule of learning knows phases and no metres, so weights serve at any wavelength: trained in a room of
// 2 m at 0.5 m, used at 4 m and more on a drive. The modules share their directions, those of one ring.
//
// Cost: 2 us a place for 10 modules of 25 cells and 12 directions.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "slam/brain/position/lahn.h"
#include "slam/brain/position/oscillators.h"

namespace penumbra::slam::brain {

struct GridModule {
  double wavelength = 0.5;  // metres
  Eigen::VectorXd start;    // phases at the origin, radians
  Eigen::MatrixXf weights;  // q: cells x (2 x directions)
};

struct GridCode {
  Eigen::Matrix2Xd directions;  // of the head-direction ring, a column each
  LahnSettings rule;
  std::vector<GridModule> modules;

  int cells() const;  // of all modules
  // The same weights at wavelengths first, first * ratio, ...
  GridCode at_scales(double first, double ratio) const;
  std::vector<Oscillators> oscillators() const;  // one for each module, at the origin
};

// Reads a code at places without allocating.
class GridCodeReader {
 public:
  explicit GridCodeReader(GridCode code);

  const GridCode& code() const { return code_; }
  // Valid until the next call.
  std::span<const float> at(std::span<const Oscillators> oscillators);
  std::span<const float> at(const Eigen::Vector2d& position);
  std::span<const float> activity() const { return activity_; }  // the last one

 private:
  GridCode code_;
  std::vector<Oscillators> oscillators_;
  std::vector<float> chi_, activity_;
};

}  // namespace penumbra::slam::brain
