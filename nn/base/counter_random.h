// Random numbers from a counter: number i of stream `seed` is a hash of both, so any of them can be had
// without the ones before, in any order and on any number of threads, and Python makes the same ones
// (weights_tools/reference/counter_random.py). For test data and benchmarks; not for secrets.
// Source: the 32-bit mixing function "lowbias32" by Chris Wellons, public domain.
#pragma once

#include <cstdint>

namespace penumbra {

inline std::uint32_t counter_hash(std::uint32_t seed, std::uint32_t i) {
  std::uint32_t x = i + 0x9E3779B9U * seed;
  x = (x ^ (x >> 16)) * 0x7FEB352DU;
  x = (x ^ (x >> 15)) * 0x846CA68BU;
  return x ^ (x >> 16);
}

// Uniform in [-1, 1), a multiple of 2^-23: the same f32 in every language.
inline float counter_uniform(std::uint32_t seed, std::uint32_t i) {
  return static_cast<float>(counter_hash(seed, i) >> 8) * 0x1p-23F - 1.0F;
}

}  // namespace penumbra
