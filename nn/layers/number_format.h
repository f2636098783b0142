// In which numbers a layer multiplies, and what numbers it was given: see docs/engine/quantisation.md.
#pragma once

#include <cstddef>

#include "nn/simd/low_precision.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

// Least and greatest input of a layer, 0 among them, averaged over the images seen.
struct InputRange {
  double low = 0.0, high = 0.0;
  int images = 0;

  void add(double image_low, double image_high) {
    ++images;
    low += (image_low - low) / images;
    high += (image_high - high) / images;
  }
};

struct NumberFormat {
  Precision precision = Precision::f32;
  Quantisation input;  // for int8 alone
  // Where not null, the layer notes its inputs there; not for threads that share a network.
  InputRange* observed = nullptr;
};

// How a map is stored that such a layer reads without converting it.
inline Numbers numbers_of(const NumberFormat& format) { return {format.precision, format.input}; }

// 0..255 over the range, so that 0 is a whole number.
Quantisation quantisation(const InputRange& range);

// All of a map's values, borders too, in a precision that is not f32; the first at data().
ArenaBuffer convert(const FeatureMap& map, const NumberFormat& format, Arena& arena);

// Notes a map's values where the format says so.
void observe(const FeatureMap& map, const NumberFormat& format);

}  // namespace penumbra::nn
