// What the levels of images with more than 8 bits mean.
#pragma once

#include "nn/image/image.h"

namespace penumbra {

// The upper 8 of the `bits` that are used, which lie low; rounded down, as libpng does. Levels beyond them
// are white.
ByteImage upper_bits(const WordImage& levels, int bits);

// Depth as sensors store it; `factor`: levels a metre.
FloatImage metres_of(const WordImage& levels, double factor);
// Depth in metres, with 0, for unknown, in place of what is not above 0 and finite.
FloatImage known_metres(FloatImage depth);

}  // namespace penumbra
