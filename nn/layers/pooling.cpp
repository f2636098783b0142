#include "nn/layers/pooling.h"

#include <algorithm>
#include <cstring>

#include "nn/base/error.h"

namespace penumbra::nn {

FeatureMap max_pool(const FeatureMap& input, PoolOptions options, Arena& arena, int output_border) {
  const auto [kernel, stride, padding] = options;
  if (kernel < 1 || stride < 1 || padding < 0 || padding > kernel / 2) {
    throw InputError("max_pool", "kernel and stride >= 1, 0 <= padding <= kernel / 2",
                     fmt::format("kernel {}, stride {}, padding {}", kernel, stride, padding));
  }
  const int height = (input.height() + 2 * padding - kernel) / stride + 1;
  const int width = (input.width() + 2 * padding - kernel) / stride + 1;
  if (input.height() + 2 * padding < kernel || input.width() + 2 * padding < kernel) {
    throw InputError("max_pool", fmt::format("an input that covers the {0} x {0} window", kernel),
                     fmt::format("{} x {} with padding {}", input.height(), input.width(), padding));
  }
  FeatureMap output(arena, input.images(), input.channels(), height, width, output_border);
#pragma omp parallel for collapse(2)
  for (int n = 0; n < output.images(); ++n) {
    for (int b = 0; b < output.blocks(); ++b) {
      for (int i = 0; i < height; ++i) {
        const int y0 = std::max(i * stride - padding, 0),
                  y1 = std::min(i * stride - padding + kernel, input.height());
        for (int j = 0; j < width; ++j) {
          const int x0 = std::max(j * stride - padding, 0),
                    x1 = std::min(j * stride - padding + kernel, input.width());
          float best[kBlock];
          std::memcpy(best, input.pixel(n, b, y0, x0), sizeof(best));
          for (int y = y0; y < y1; ++y) {
            for (int x = x0; x < x1; ++x) {
              const float* in = input.pixel(n, b, y, x);
              for (int c = 0; c < kBlock; ++c) best[c] = std::max(best[c], in[c]);
            }
          }
          std::memcpy(output.pixel(n, b, i, j), best, sizeof(best));
        }
      }
    }
  }
  return output;
}

}  // namespace penumbra::nn
