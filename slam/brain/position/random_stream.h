// A stream of random numbers for walks, first weights and noise: the same on every machine for a seed.
//
//   normal   z = sqrt(-2 ln(1 - u1)) cos(2 pi u2)      u1, u2 uniform in [0, 1)
//
// Source: Box and Muller, A note on the generation of random normal deviates (1958).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "nn/base/counter_random.h"

namespace penumbra::slam::brain {

class RandomStream {
 public:
  // Streams of one seed with different names are independent.
  explicit RandomStream(std::uint64_t seed, std::uint64_t name = 0) : seed_(counter_random(seed, name)) {}

  double uniform() { return counter_uniform(seed_, counter_++); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t seed_, counter_ = 0;
};

}  // namespace penumbra::slam::brain
