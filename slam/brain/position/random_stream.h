// A stream of random numbers for walks, first weights and noise: the same on every machine for a seed.
#pragma once

#include <cstdint>

#include "nn/base/counter_random.h"

namespace penumbra::slam::brain {

class RandomStream {
 public:
  // Streams of one seed with different names are independent.
  explicit RandomStream(std::uint64_t seed, std::uint64_t name = 0) : seed_(counter_random(seed, name)) {}

  double uniform() { return counter_uniform(seed_, counter_++); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() {
    const double u = uniform(), v = uniform();  // in this order
    return normal_of(u, v);
  }

 private:
  std::uint64_t seed_, counter_ = 0;
};

}  // namespace penumbra::slam::brain
