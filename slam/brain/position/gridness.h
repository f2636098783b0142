// How hexagonal a rate map is: its autocorrelogram, cut to a ring round the centre, is turned and compared
// with itself.
//
//   c(a)      correlation of the ring with itself turned by a degrees (bilinear)
//   gridness  min(c(60), c(120)) - max(c(30), c(90), c(150))        -2..2
//
//   fixed   the ring from 0.5 to 1.4 spacings, which is known from the wavelength: spacing = 2 / sqrt(3)
//           wavelength
//   best    the largest value of all rings that begin where the centre's peak ends and are 4 bins wide or
//           more
//
// A perfect lattice has 1.40 on the fixed ring, squares -1.34, stripes -0.10, noise -0.33. A map without any
// change has 0.
//
// Cost: 1 ms for 40 x 40 bins.
// Source: fixed, Sargolini et al. (2006); best, Langston et al., Development of the spatial representation
// system in the rat (2010).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "slam/brain/position/autocorrelogram.h"

namespace penumbra::slam::brain {

struct GridnessScores {
  double fixed = 0.0, best = 0.0;
};

// Keeps where the bins of the turned rings lie; for maps of one size.
class Gridness {
 public:
  // `radius` of the autocorrelograms that score() gets.
  explicit Gridness(int radius);

  // `spacing` of the lattice in bins.
  GridnessScores score(const Autocorrelogram& map, double spacing) const;

 private:
  struct Turned {  // where a bin comes from: a corner and how far beyond it
    int dx = 0, dy = 0;
    float right = 0.0F, up = 0.0F;
  };
  static constexpr int kTurns = 6;  // 0, 30, ... 150 degrees

  int radius_;                                      // of the largest ring
  std::array<std::vector<Turned>, kTurns> turned_;  // the bins of the disc, the nearest first
  std::vector<std::size_t> within_;                 // within_[i]: how many of them are nearer than i bins
};

// Of the cells of one network or several.
struct GridnessSummary {
  double median = 0.0;
  double share = 0.0;  // above 0.3
};
GridnessSummary summary_of(std::span<const double> scores);

}  // namespace penumbra::slam::brain
