#include "nn/layers/prototype_mask.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/layers/activations.h"

namespace penumbra::nn {

namespace {

// Where an image pixel samples the prototypes along one axis: two neighbours and the second's weight.
struct Sample {
  int low, high;
  float fraction;
};

Sample sample_at(int pixel, float scale, float offset, int extent) {
  const float position = std::clamp((static_cast<float>(pixel) + 0.5F) * scale + offset - 0.5F, 0.0F,
                                    static_cast<float>(extent - 1));
  const int low = static_cast<int>(position);
  return {low, std::min(low + 1, extent - 1), position - static_cast<float>(low)};
}

std::vector<Sample> samples(int begin, int count, float scale, float offset, int extent) {
  std::vector<Sample> positions;
  for (int i = 0; i < count; ++i) positions.push_back(sample_at(begin + i, scale, offset, extent));
  return positions;
}

}  // namespace

Mask prototype_mask(const FeatureMap& prototypes, std::span<const float> weights, const PrototypeFrame& frame,
                    const Box& box, int image_width, int image_height, float threshold) {
  Mask mask;
  mask.x = static_cast<int>(std::ceil(std::clamp(box.x1, 0.0F, static_cast<float>(image_width))));
  mask.y = static_cast<int>(std::ceil(std::clamp(box.y1, 0.0F, static_cast<float>(image_height))));
  mask.width =
      static_cast<int>(std::ceil(std::clamp(box.x2, 0.0F, static_cast<float>(image_width)))) - mask.x;
  mask.height =
      static_cast<int>(std::ceil(std::clamp(box.y2, 0.0F, static_cast<float>(image_height)))) - mask.y;
  if (mask.width <= 0 || mask.height <= 0) {
    mask.width = mask.height = 0;
    return mask;
  }
  const std::vector<Sample> columns =
      samples(mask.x, mask.width, frame.scale_x, frame.left, prototypes.width());
  const std::vector<Sample> rows =
      samples(mask.y, mask.height, frame.scale_y, frame.top, prototypes.height());

  // The probabilities of the prototype pixels that some sample reads.
  const int x0 = columns.front().low, y0 = rows.front().low;
  const int width = columns.back().high + 1 - x0, height = rows.back().high + 1 - y0;
  std::vector<float> probabilities(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  float* next = probabilities.data();
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

  mask.bits.reserve(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  for (const Sample& row : rows) {
    const float* upper = probabilities.data() + static_cast<std::ptrdiff_t>(row.low - y0) * width - x0;
    const float* lower = probabilities.data() + static_cast<std::ptrdiff_t>(row.high - y0) * width - x0;
    for (const Sample& column : columns) {
      const float top = upper[column.low] + column.fraction * (upper[column.high] - upper[column.low]);
      const float bottom = lower[column.low] + column.fraction * (lower[column.high] - lower[column.low]);
      mask.bits.push_back(top + row.fraction * (bottom - top) > threshold ? 1 : 0);
    }
  }
  return mask;
}

}  // namespace penumbra::nn
