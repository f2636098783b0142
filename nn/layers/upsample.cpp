#include "nn/layers/upsample.h"

#include <algorithm>
#include <cstring>

#include "nn/base/error.h"
#include "nn/base/linear_sample.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

// PyTorch's nearest: the scale is a float, the product is floored.
int nearest(int i, float scale, int extent) {
  return std::min(static_cast<int>(static_cast<float>(i) * scale), extent - 1);
}

LinearSample bilinear(int i, int input, int output, bool align_corners) {
  if (!align_corners) {
    return linear_sample(half_pixel(i, static_cast<float>(input) / static_cast<float>(output)), input);
  }
  if (output == 1) return linear_sample(0.0F, input);
  return linear_sample(
      static_cast<float>(i) * (static_cast<float>(input - 1) / static_cast<float>(output - 1)), input);
}

void check_size(const char* name, const FeatureMap& input, int height, int width) {
  if (height < 1 || width < 1 || input.height() < 1 || input.width() < 1) {
    throw InputError(name, "at least one pixel in and out",
                     fmt::format("{} x {} to {} x {}", input.height(), input.width(), height, width));
  }
}

}  // namespace

FeatureMap upsample_nearest(const FeatureMap& input, int height, int width, Arena& arena, int output_border) {
  check_size("upsample_nearest", input, height, width);
  FeatureMap output(arena, input.batch(), input.channels(), height, width, output_border, input.block());
  const float scale_y = static_cast<float>(input.height()) / static_cast<float>(height);
  const float scale_x = static_cast<float>(input.width()) / static_cast<float>(width);
  const std::size_t pixel_bytes = static_cast<std::size_t>(input.block()) * sizeof(float);
  parallel_for({output.images(), output.blocks(), height}, grain_of(output.row_stride()),
               [&](int n, int b, int i) {
                 const float* from = input.pixel(n, b, nearest(i, scale_y, input.height()), 0);
                 float* to = output.pixel(n, b, i, 0);
                 for (int j = 0; j < width; ++j, to += input.block()) {
                   std::memcpy(to, from + nearest(j, scale_x, input.width()) * input.block(), pixel_bytes);
                 }
               });
  return output;
}

void add_upsampled(const FeatureMap& x, FeatureMap& y) {
  if (x.images() != y.images() || x.channels() != y.channels()) {
    throw InputError("add_upsampled", fmt::format("{} images of {} channels", y.images(), y.channels()),
                     fmt::format("{} of {}", x.images(), x.channels()));
  }
  const float scale_y = static_cast<float>(x.height()) / static_cast<float>(y.height());
  const float scale_x = static_cast<float>(x.width()) / static_cast<float>(y.width());
  parallel_for({y.images(), y.blocks(), y.height()}, grain_of(y.row_stride()), [&](int n, int b, int i) {
    for (int j = 0; j < y.width(); ++j) {
      const float* from = x.pixel(n, b, nearest(i, scale_y, x.height()), nearest(j, scale_x, x.width()));
      float* to = y.pixel(n, b, i, j);
      for (int c = 0; c < kBlock; ++c) to[c] += from[c];
    }
  });
}

FeatureMap upsample_bilinear(const FeatureMap& input, int height, int width, bool align_corners, Arena& arena,
                             int output_border) {
  check_size("upsample_bilinear", input, height, width);
  FeatureMap output(arena, input.batch(), input.channels(), height, width, output_border, input.block());
  const int block = input.block();
  parallel_for({output.images(), output.blocks(), height}, grain_of(output.row_stride()),
               [&](int n, int b, int i) {
                 const LinearSample row = bilinear(i, input.height(), height, align_corners);
                 const float* upper = input.pixel(n, b, row.low, 0);
                 const float* lower = input.pixel(n, b, row.high, 0);
                 float* to = output.pixel(n, b, i, 0);
                 for (int j = 0; j < width; ++j, to += block) {
                   const LinearSample column = bilinear(j, input.width(), width, align_corners);
                   const float w11 = row.fraction * column.fraction, w10 = row.fraction - w11;
                   const float w01 = column.fraction - w11, w00 = 1.0F - row.fraction - w01;
                   const std::ptrdiff_t left = static_cast<std::ptrdiff_t>(column.low) * block;
                   const std::ptrdiff_t right = static_cast<std::ptrdiff_t>(column.high) * block;
                   for (int c = 0; c < block; ++c) {
                     to[c] = w00 * upper[left + c] + w01 * upper[right + c] + w10 * lower[left + c] +
                             w11 * lower[right + c];
                   }
                 }
               });
  return output;
}

}  // namespace penumbra::nn
