// The head-direction layer: a ring of n cells, each with a preferred direction that a self-organising map
// finds. The ring keeps the heading as a point on the unit circle, which the turn rate moves:
//
//   s <- R(omega dt) s                      s = (cos h, sin h)
//   r_i = w_i . s                           the response of cell i: cos(h - theta_i), as |w_i| = 1
//   winner c = argmax r_i,   w_i <- normalise( w_i + eta exp(-d(i, c)^2 / (2 sigma^2)) (s - w_i)
//                                              + beta (w_i-1 - 2 w_i + w_i+1) )
//
// d is the distance along the ring in cells; eta and sigma fall geometrically while it learns. Grid cells
// need the directions even: 2 degrees of error cost 0.04 of gridness, 5 degrees 0.24, 10 all of it. The
// headings of a walk are not even: without the tension beta between neighbours the map follows them, and a
// gap is 6 degrees off after the 1000 seconds; with it 0.2.
//
// Cost: 15 n operations a step.
// Source: Chen et al. (docs/papers.md, D.1) name the map and its input and nothing else. The rule is
// Kohonen's, Self-organized formation of topologically correct feature maps (1982); the tension is that of
// Durbin and Willshaw, An analogue approach to the travelling salesman problem using an elastic net method
// (1987).
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace penumbra::slam::brain {

struct RingSettings {
  int directions = 12;                         // n, a multiple of 6: hexagons are of waves at 60 degrees
  int steps = 20'000;                          // of the training
  double step = 0.05;                          // dt, seconds
  double first_rate = 0.3, last_rate = 0.002;  // eta
  double first_width = 3.0, last_width = 0.5;  // sigma, cells
  double last_tension = 0.1;                   // beta, which grows from 0 in the second half
};

class HeadDirectionRing {
 public:
  // Cells that prefer random directions. InputError unless n is a positive multiple of 6.
  HeadDirectionRing(const RingSettings& settings, std::uint64_t seed);
  // With directions that were found before, a column each.
  explicit HeadDirectionRing(const Eigen::Matrix2Xd& weights) : weights_(weights) {}
  // The same, then trained on turns that wander as those of a RandomWalk.
  static HeadDirectionRing trained(const RingSettings& settings, std::uint64_t seed);

  // `turn_rate` in rad/s.
  void turn(double turn_rate, double seconds);
  // Radians from the x axis to the y axis.
  void set_heading(double heading);
  double heading() const;
  // One step of the map at the present heading; eta, sigma and beta.
  void learn(double rate, double width, double tension);

  int directions() const { return static_cast<int>(weights_.cols()); }
  const Eigen::Matrix2Xd& weights() const { return weights_; }  // a column a cell
  double response(int cell) const { return weights_.col(cell).dot(state_); }
  // By how much the angle between two neighbours is at most off 2 pi / n, radians.
  double unevenness() const;

 private:
  Eigen::Matrix2Xd weights_, before_;
  Eigen::Vector2d state_{1.0, 0.0};
};

}  // namespace penumbra::slam::brain
