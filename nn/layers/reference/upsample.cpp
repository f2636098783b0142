// Naive upsampling.
#include <algorithm>
#include <cmath>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

namespace {

// The ratio of the extents is an f32 by definition: it decides which pixel is the nearest.
std::int64_t nearest(std::int64_t i, std::int64_t input, std::int64_t output) {
  const float scale = static_cast<float>(input) / static_cast<float>(output);
  return std::min(static_cast<std::int64_t>(std::floor(static_cast<float>(i) * scale)), input - 1);
}

double bilinear_position(std::int64_t i, std::int64_t input, std::int64_t output, bool align_corners) {
  const auto a = static_cast<double>(input), b = static_cast<double>(output), k = static_cast<double>(i);
  if (align_corners) return output > 1 ? k * (a - 1.0) / (b - 1.0) : 0.0;
  return std::max((k + 0.5) * a / b - 0.5, 0.0);
}

}  // namespace

Tensor upsample_nearest(const Tensor& x, std::int64_t height, std::int64_t width) {
  Tensor y({x.extent(0), x.extent(1), height, width});
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < y.extent(1); ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        for (std::int64_t j = 0; j < width; ++j) {
          y.at(n, c, i, j) = x.at(n, c, nearest(i, x.extent(2), height), nearest(j, x.extent(3), width));
        }
      }
    }
  }
  return y;
}

Tensor add_upsampled(const Tensor& x, const Tensor& y) {
  return add(y, upsample_nearest(x, y.extent(2), y.extent(3)));
}

Tensor upsample_bilinear(const Tensor& x, std::int64_t height, std::int64_t width, bool align_corners) {
  Tensor y({x.extent(0), x.extent(1), height, width});
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < y.extent(1); ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        const double row = bilinear_position(i, x.extent(2), height, align_corners);
        const std::int64_t y0 = std::min(static_cast<std::int64_t>(row), x.extent(2) - 1);
        const std::int64_t y1 = std::min(y0 + 1, x.extent(2) - 1);
        const double fy = row - static_cast<double>(y0);
        for (std::int64_t j = 0; j < width; ++j) {
          const double column = bilinear_position(j, x.extent(3), width, align_corners);
          const std::int64_t x0 = std::min(static_cast<std::int64_t>(column), x.extent(3) - 1);
          const std::int64_t x1 = std::min(x0 + 1, x.extent(3) - 1);
          const double fx = column - static_cast<double>(x0);
          y.at(n, c, i, j) =
              static_cast<float>((1 - fy) * ((1 - fx) * x.at(n, c, y0, x0) + fx * x.at(n, c, y0, x1)) +
                                 fy * ((1 - fx) * x.at(n, c, y1, x0) + fx * x.at(n, c, y1, x1)));
        }
      }
    }
  }
  return y;
}

}  // namespace penumbra::nn::reference
