// Networks with weights from the counter-based generator, and images made from it: what
// weights_tools/reference/make_*_fixtures.py give PyTorch, number for number.
#pragma once

#include "nn/image/image.h"
#include "nn/models/random_weights.h"

namespace penumbra::test {

using nn::random_mask_rcnn;
using nn::random_state;
using nn::Shapes;

// Blocks of random colour, 8 x 8 pixels each, and noise; BGR.
ByteImage random_image(std::uint32_t seed, int width, int height);

}  // namespace penumbra::test
