// The oscillators of one module: one for each preferred direction, whose phase is the way gone in that
// direction.
//
//   phi_j <- phi_j + kappa v r_j dt         kappa = 2 pi / wavelength, r_j = the ring's response
//   phi_j  = phi_j(0) + k_j . x             so the phase depends on the place alone: k_j = kappa w_j
//   chi    = (cos phi_1 .. cos phi_n, sin phi_1 .. sin phi_n)
//   chi_exc = R_p max(chi, 0),   chi_inh = min(chi, 0),   chi <- chi_exc + chi_inh
//   R_p    = 1 - exp(-|X_w - X_p| / b)      with the boundary factor, else 1
//
// The place comes back from the phases by least squares, exactly, as the phases are not reduced to a turn.
//
// Cost: n multiplications a step, n sines and cosines for the outputs.
// Source: Chen et al. (docs/papers.md, D.1). Open there, and chosen here: the start phases (random), sine
// beside cosine (without it no network of the kind makes lattices), the formula of R_p and its length b; the
// damping mu = 1, taken as d rho / dt = mu rho (1 - rho^2), whose amplitude rho = 1 nothing disturbs, so it
// is no variable.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "slam/brain/position/head_direction_ring.h"

namespace penumbra::slam::brain {

class Oscillators {
 public:
  // `directions` are the ring's weights, a column each; `start` the phases at the origin, radians.
  Oscillators(const Eigen::Matrix2Xd& directions, const Eigen::VectorXd& start, double wavelength);
  static Eigen::VectorXd random_start(int directions, std::uint64_t seed);

  void advance(const HeadDirectionRing& ring, double speed, double seconds);  // m/s, s
  void place(const Eigen::Vector2d& position);                                // metres
  Eigen::Vector2d position() const;

  double wavelength() const { return wavelength_; }  // metres
  int outputs() const { return 2 * static_cast<int>(phases_.size()); }
  void output(std::span<float> chi) const;

 private:
  double wavelength_;
  Eigen::Matrix2Xd waves_;                            // k_j, radians a metre
  Eigen::Matrix<double, 2, Eigen::Dynamic> inverse_;  // least squares: x = inverse (phi - phi(0))
  Eigen::VectorXd start_, phases_;
};

// R_p, and what it makes of outputs. `wall` is the distance to the wall ahead, metres.
double boundary_factor(double wall);
void apply_boundary_factor(double factor, std::span<float> chi);

}  // namespace penumbra::slam::brain
