// Random numbers as a pure function of (seed, counter): the same on every machine, in every order of calls.
//
//   z = seed + (counter + 1) * golden;  z = (z ^ z>>30) * m1;  z = (z ^ z>>27) * m2;  z ^= z>>31
//
// Source: Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators (2014), SplitMix64.
#pragma once

#include <cstdint>

namespace penumbra::slam {

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

}  // namespace penumbra::slam
