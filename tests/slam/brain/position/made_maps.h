// Rate maps of known shape for tests.
#pragma once

#include <cmath>

#include "slam/brain/position/rate_map.h"

namespace penumbra::test {

// rate(x, y) in bins from the middle; all known.
template <class Rate>
slam::brain::RateMap made_map(int size, const Rate& rate) {
  slam::brain::RateMap map;
  map.size = size;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      map.rate.push_back(static_cast<float>(rate(column - 0.5 * size, row - 0.5 * size)));
      map.known.push_back(1);
    }
  }
  return map;
}

// The sum of plane waves of a wavelength (bins) in `directions` evenly over half a turn: 1 stripes, 2
// squares, 3 hexagons.
inline slam::brain::RateMap waves_map(int size, int directions, double wavelength, double turn = 0.2) {
  constexpr double kPi = 3.14159265358979;
  return made_map(size, [=](double x, double y) {
    double sum = 0.0;
    for (int i = 0; i < directions; ++i) {
      const double angle = turn + kPi * i / directions;
      sum += std::cos(2.0 * kPi / wavelength * (x * std::cos(angle) + y * std::sin(angle)) + 0.7 * i);
    }
    return sum > 0.0 ? sum : 0.0;
  });
}

}  // namespace penumbra::test
