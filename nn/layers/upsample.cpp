#include "nn/layers/upsample.h"

#include <algorithm>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

// PyTorch's nearest: the scale is a float, the product is floored.
int nearest(int i, float scale, int extent) {
  return std::min(static_cast<int>(static_cast<float>(i) * scale), extent - 1);
}

}  // namespace

void add_upsampled(const FeatureMap& x, FeatureMap& y) {
  if (x.images() != y.images() || x.channels() != y.channels()) {
    throw InputError("add_upsampled", fmt::format("{} images of {} channels", y.images(), y.channels()),
                     fmt::format("{} of {}", x.images(), x.channels()));
  }
  const float scale_y = static_cast<float>(x.height()) / static_cast<float>(y.height());
  const float scale_x = static_cast<float>(x.width()) / static_cast<float>(y.width());
#pragma omp parallel for collapse(2)
  for (int n = 0; n < y.images(); ++n) {
    for (int b = 0; b < y.blocks(); ++b) {
      for (int i = 0; i < y.height(); ++i) {
        for (int j = 0; j < y.width(); ++j) {
          const float* from = x.pixel(n, b, nearest(i, scale_y, x.height()), nearest(j, scale_x, x.width()));
          float* to = y.pixel(n, b, i, j);
          for (int c = 0; c < kBlock; ++c) to[c] += from[c];
        }
      }
    }
  }
}

}  // namespace penumbra::nn
