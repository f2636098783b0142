#include "nn/layers/prototype_mask.h"

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "nn/base/linear_sample.h"
#include "nn/layers/activations.h"

namespace penumbra::nn {

namespace {

// Where image pixel i samples an axis of the prototypes.
LinearSample sample_at(int i, float scale, float offset, int extent) {
  return linear_sample((static_cast<float>(i) + 0.5F) * scale + offset - 0.5F, extent);
}

}  // namespace

void prototype_mask(const FeatureMap& prototypes, std::span<const float> weights, const PrototypeFrame& frame,
                    const Box& box, int image_width, int image_height, float threshold,
                    std::span<float> scratch, Mask& mask) {
  if (std::ssize(scratch) < static_cast<std::ptrdiff_t>(prototypes.height()) * prototypes.width()) {
    throw InputError("prototype_mask",
                     fmt::format("scratch of {} x {}", prototypes.height(), prototypes.width()),
                     fmt::format("{}", scratch.size()));
  }
  const auto first_pixel = [](float edge, int extent) {
    return static_cast<int>(std::ceil(std::clamp(edge, 0.0F, static_cast<float>(extent))));
  };
  mask.x = first_pixel(box.x1, image_width);
  mask.y = first_pixel(box.y1, image_height);
  mask.width = first_pixel(box.x2, image_width) - mask.x;
  mask.height = first_pixel(box.y2, image_height) - mask.y;
  if (mask.width <= 0 || mask.height <= 0) {
    mask.width = mask.height = 0;
    mask.bits.clear();
    return;
  }
  const auto column_at = [&](int x) { return sample_at(x, frame.scale_x, frame.left, prototypes.width()); };
  const auto row_at = [&](int y) { return sample_at(y, frame.scale_y, frame.top, prototypes.height()); };

  // The probabilities of the prototype pixels that some sample reads.
  const int x0 = column_at(mask.x).low, y0 = row_at(mask.y).low;
  const int width = column_at(mask.x + mask.width - 1).high + 1 - x0;
  const int height = row_at(mask.y + mask.height - 1).high + 1 - y0;
  float* next = scratch.data();
  const int channels = std::min(static_cast<int>(weights.size()), prototypes.channels());
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) {
      float sum = 0.0F;
      for (int c = 0; c < channels; c += kBlock) {
        const float* values = prototypes.pixel(0, c / kBlock, y, x);
        const int lanes = std::min(kBlock, channels - c);
        for (int l = 0; l < lanes; ++l) sum += weights[static_cast<std::size_t>(c + l)] * values[l];
      }
      *next++ = sigmoid(sum);
    }
  }

  mask.bits.resize(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  std::uint8_t* out = mask.bits.data();
  for (int y = mask.y; y < mask.y + mask.height; ++y) {
    const LinearSample row = row_at(y);
    const float* upper = scratch.data() + static_cast<std::ptrdiff_t>(row.low - y0) * width;
    const float* lower = scratch.data() + static_cast<std::ptrdiff_t>(row.high - y0) * width;
    for (int x = mask.x; x < mask.x + mask.width; ++x) {
      const LinearSample column = column_at(x);
      const int left = column.low - x0, right = column.high - x0;
      const float top = upper[left] + column.fraction * (upper[right] - upper[left]);
      const float bottom = lower[left] + column.fraction * (lower[right] - lower[left]);
      *out++ = top + row.fraction * (bottom - top) > threshold ? 1 : 0;
    }
  }
}

}  // namespace penumbra::nn
