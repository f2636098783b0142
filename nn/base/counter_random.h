// Random numbers from a counter: number i of stream `seed` is a hash of both, so any of them can be had
// without the ones before, in any order and on any number of threads. For test data, sampling and benchmarks;
// not for secrets.
//
//   64 bits  z = seed + (counter + 1) * golden;  z = (z ^ z>>30) * m1;  z = (z ^ z>>27) * m2;  z ^= z>>31
//   32 bits  for the f32 of test data and random weights, which Python makes as well
//            (weights_tools/reference/counter_random.py)
//
// Source: Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators (2014), SplitMix64; the 32-bit
// mixing function "lowbias32" by Chris Wellons, public domain.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace penumbra {

// 64 random bits.
inline std::uint64_t counter_random(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed + (counter + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

// Uniform in [0, 1), on a grid of 2^-53: exact in every step, hence equal on every machine.
inline double counter_uniform(std::uint64_t seed, std::uint64_t counter) {
  return static_cast<double>(counter_random(seed, counter) >> 11) * 0x1.0p-53;
}

// A standard normal number of two uniform ones in [0, 1): Box, Muller, A note on the generation of random
// normal deviates (1958).
inline double normal_of(double u, double v) {
  return std::sqrt(-2.0 * std::log(1.0 - u)) * std::cos(2.0 * std::numbers::pi * v);
}

// Uniform in [-1, 1), a multiple of 2^-23: the same f32 in every language.
inline float counter_uniform_f32(std::uint32_t seed, std::uint32_t counter) {
  std::uint32_t x = counter + 0x9E3779B9U * seed;
  x = (x ^ (x >> 16)) * 0x7FEB352DU;
  x = (x ^ (x >> 15)) * 0x846CA68BU;
  return static_cast<float>((x ^ (x >> 16)) >> 8) * 0x1p-23F - 1.0F;
}

}  // namespace penumbra
