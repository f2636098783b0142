// Procedural noise: random numbers that are functions of a place and a seed, so that a surface looks the same
// from every camera, in every frame and on every thread.
//
//   value noise:    n(x, y) interpolates hash(cell corner) in [-1, 1] with the weights 3f^2 - 2f^3
//   fractal noise:  sum over octaves k of  gain^k w_k n(p / wavelength_k),  wavelength_k = wavelength_0 / 2^k
//   band limit:     w_k = clamp(wavelength_k / (2 footprint) - 1, 0, 1): an octave fades out before a pixel
//                   of `footprint` metres could no longer sample it (Nyquist), so textures do not alias.
//
// With a gain near 1 every distance has detail of a few pixels, which is what corner detectors need.
// Source: Perlin, An Image Synthesizer, SIGGRAPH 1985; band limit as in Musgrave, Kolb, Mace, SIGGRAPH 1989.
#pragma once

#include <algorithm>
#include <cstdint>

namespace penumbra::slam::synthetic {

// Mixes all bits of `x` (the finaliser of MurmurHash3).
inline std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85ebca6bU;
  x ^= x >> 13;
  x *= 0xc2b2ae35U;
  return x ^ (x >> 16);
}

inline std::uint32_t hash_of(std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0) {
  return mix_bits(a + 0x9e3779b9U * mix_bits(b + 0x7f4a7c15U * mix_bits(c + 0x165667b1U)));
}

// A hash as a number in [0, 1).
inline float to_unit(std::uint32_t hash) { return static_cast<float>(hash >> 8) * (1.0F / 16777216.0F); }

// std::floor without a library call: |x| must stay below 2^31.
inline int floor_int(float x) {
  const int i = static_cast<int>(x);
  return i - static_cast<int>(x < static_cast<float>(i));
}

inline float clamp01(float x) { return std::min(std::max(x, 0.0F), 1.0F); }
inline float mix(float a, float b, float weight) { return a + (b - a) * weight; }
inline float smooth_step(float edge0, float edge1, float x) {
  const float t = clamp01((x - edge0) / (edge1 - edge0));
  return t * t * (3.0F - 2.0F * t);
}

namespace detail {

constexpr std::uint32_t kPrimeX = 0x9e3779b1U, kPrimeY = 0x85ebca77U, kPrimeZ = 0xc2b2ae3dU;

// One round is enough for a lattice value: the product carries every bit of `h` into the high bits, which are
// those that count.
inline float lattice(std::uint32_t h) {
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  return static_cast<float>(static_cast<std::int32_t>(h)) * (1.0F / 2147483648.0F);
}

inline float fade(float f) { return f * f * (3.0F - 2.0F * f); }

}  // namespace detail

// Smooth noise in [-1, 1] with unit cells.
inline float value_noise(float x, float y, std::uint32_t seed) {
  const int ix = floor_int(x), iy = floor_int(y);
  const float fx = detail::fade(x - static_cast<float>(ix)), fy = detail::fade(y - static_cast<float>(iy));
  const std::uint32_t x0 = static_cast<std::uint32_t>(ix) * detail::kPrimeX + seed, x1 = x0 + detail::kPrimeX;
  const std::uint32_t y0 = static_cast<std::uint32_t>(iy) * detail::kPrimeY, y1 = y0 + detail::kPrimeY;
  const float top = mix(detail::lattice(x0 ^ y0), detail::lattice(x1 ^ y0), fx);
  const float bottom = mix(detail::lattice(x0 ^ y1), detail::lattice(x1 ^ y1), fx);
  return mix(top, bottom, fy);
}

inline float value_noise(float x, float y, float z, std::uint32_t seed) {
  const int iz = floor_int(z);
  const float fz = detail::fade(z - static_cast<float>(iz));
  const std::uint32_t z0 = static_cast<std::uint32_t>(iz) * detail::kPrimeZ;
  return mix(value_noise(x, y, seed ^ z0), value_noise(x, y, seed ^ (z0 + detail::kPrimeZ)), fz);
}

struct Octaves {
  float cell = 1.0F;  // metres, of the first octave
  int count = 6;
  float gain = 0.8F;  // amplitude of an octave over the one before
};

// The weight of detail with a period of `period` metres where a pixel covers `footprint` metres: 0 from the
// Nyquist limit (two pixels a period) on, 1 from twice that.
inline float band_weight(float period, float footprint) { return clamp01(0.5F * period / footprint - 1.0F); }

inline float emphasise(float n) { return n * (0.5F + 1.5F * n * n); }

// Band-limited fractal noise over a surface; about zero mean, mostly within [-1.5, 1.5].
inline float fractal_noise(float x, float y, float footprint, const Octaves& octaves, std::uint32_t seed) {
  float sum = 0.0F, amplitude = 1.0F, cell = octaves.cell;
  float px = x / cell, py = y / cell;
  for (int k = 0; k < octaves.count; ++k) {
    const float weight = band_weight(2.0F * cell, footprint);
    if (weight <= 0.0F) break;  // finer octaves have none either
    sum += amplitude * weight * emphasise(value_noise(px, py, seed + static_cast<std::uint32_t>(k)));
    amplitude *= octaves.gain;
    cell *= 0.5F;
    // Each octave is turned by 37 degrees as well, so that the lattices never line up.
    const float rx = 1.5972710F * px - 1.2036300F * py, ry = 1.2036300F * px + 1.5972710F * py;
    px = rx;
    py = ry;
  }
  return sum;
}

inline float fractal_noise(float x, float y, float z, float footprint, const Octaves& octaves,
                           std::uint32_t seed) {
  float sum = 0.0F, amplitude = 1.0F, cell = octaves.cell;
  for (int k = 0; k < octaves.count; ++k) {
    const float weight = band_weight(2.0F * cell, footprint);
    if (weight <= 0.0F) break;
    const float scale = 1.0F / cell;
    sum += amplitude * weight *
           emphasise(value_noise(x * scale, y * scale, z * scale, seed + static_cast<std::uint32_t>(k)));
    amplitude *= octaves.gain;
    cell *= 0.5F;
  }
  return sum;
}

// Round spots on a surface, for corners that stand out from the noise: two of three squares of `cell` metres
// have one, wholly inside the square, with a radius of 0.08 to 0.25 cells. The value is the spot's own tone,
// 0.5..1 or -1..-0.5, and 0 outside; it is softened by the pixel's footprint and fades before a spot becomes
// smaller than a pixel.
inline float spots(float x, float y, float cell, float footprint, std::uint32_t seed) {
  const float weight = band_weight(0.5F * cell, footprint);
  if (weight <= 0.0F) return 0.0F;
  const float u = x / cell, v = y / cell;
  const int iu = floor_int(u), iv = floor_int(v);
  const std::uint32_t h = hash_of(static_cast<std::uint32_t>(iu), static_cast<std::uint32_t>(iv), seed);
  if (h % 3U == 0U) return 0.0F;
  const auto byte = [&](int shift) { return static_cast<float>((h >> shift) & 255U) * (1.0F / 255.0F); };
  const float radius = 0.08F + 0.17F * byte(8) * byte(8);
  const float du = u - static_cast<float>(iu) - (0.28F + 0.44F * byte(16));
  const float dv = v - static_cast<float>(iv) - (0.28F + 0.44F * byte(24));
  // Squashed a little, so that outlines differ.
  const float squash = 0.75F + 0.5F * byte(4);
  const float distance = du * du * squash + dv * dv / squash;
  const float soft = std::max(footprint / cell, 0.1F * radius);
  const float inside = clamp01((radius * radius - distance) / (2.0F * radius * soft) + 0.5F);
  return weight * inside * ((h & 2U) != 0U ? 1.0F : -1.0F) * (0.5F + 0.5F * byte(1));
}

// Spots of three sizes, so that some are a few pixels large at any distance.
inline float speckle(float x, float y, float footprint, std::uint32_t seed) {
  return spots(x, y, 0.17F, footprint, seed) + spots(y, x, 0.53F, footprint, seed + 1U) +
         0.7F * spots(x, -y, 1.7F, footprint, seed + 2U);
}

// Box-filtered indicator of [from, to] at `x` for a pixel `width` wide: 1 inside, 0 outside, between at
// edges.
inline float pulse(float x, float from, float to, float width) {
  const float w = 1.0F / std::max(width, 1e-4F);
  return clamp01((x - from) * w + 0.5F) - clamp01((x - to) * w + 0.5F);
}

// A sequence of random numbers, for building worlds: the same on every machine, unlike <random>. At most one
// draw goes into an argument list or an operation: compilers differ in which operand they evaluate first.
class RandomSequence {
 public:
  explicit RandomSequence(std::uint32_t seed) : seed_(seed) {}
  std::uint32_t bits() { return hash_of(seed_, ++count_, 0x51a3U); }
  float uniform(float from = 0.0F, float to = 1.0F) { return from + (to - from) * to_unit(bits()); }
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint32_t>(n)); }
  bool chance(float probability) { return uniform() < probability; }

 private:
  std::uint32_t seed_, count_ = 0;
};

}  // namespace penumbra::slam::synthetic
