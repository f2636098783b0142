// Depth images as sensors store them.
#pragma once

#include "nn/image/image.h"

namespace penumbra::slam {

// Metres of whole-number levels, `factor` of them a metre; level 0, unknown, stays 0.
FloatImage metres_of(const WordImage& levels, double factor);

}  // namespace penumbra::slam
