#include "nn/layers/mask_paste.h"

#include <algorithm>

#include "nn/base/linear_sample.h"

namespace penumbra::nn {

void paste_mask(std::span<const float> probabilities, int size, const Box& box, int image_width,
                int image_height, float threshold, Mask& mask) {
  const int padded_size = size + 2;
  const float growth = static_cast<float>(padded_size) / static_cast<float>(size);
  const float half_width = (box.x2 - box.x1) * 0.5F * growth, half_height = (box.y2 - box.y1) * 0.5F * growth;
  const float centre_x = (box.x2 + box.x1) * 0.5F, centre_y = (box.y2 + box.y1) * 0.5F;
  const int x1 = static_cast<int>(centre_x - half_width), x2 = static_cast<int>(centre_x + half_width);
  const int y1 = static_cast<int>(centre_y - half_height), y2 = static_cast<int>(centre_y + half_height);
  const int width = std::max(x2 - x1 + 1, 1), height = std::max(y2 - y1 + 1, 1);

  mask.x = std::clamp(x1, 0, image_width);
  mask.y = std::clamp(y1, 0, image_height);
  mask.width = std::max(std::min(x2 + 1, image_width) - mask.x, 0);
  mask.height = std::max(std::min(y2 + 1, image_height) - mask.y, 0);
  mask.bits.resize(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));

  const float scale_x = static_cast<float>(padded_size) / static_cast<float>(width);
  const float scale_y = static_cast<float>(padded_size) / static_cast<float>(height);
  // The map with its border of zeros.
  const auto value = [&](int row, int column) {
    const bool inside = row >= 1 && column >= 1 && row <= size && column <= size;
    return inside ? probabilities[static_cast<std::size_t>((row - 1) * size + column - 1)] : 0.0F;
  };
  std::uint8_t* out = mask.bits.data();
  for (int y = mask.y; y < mask.y + mask.height; ++y) {
    const LinearSample row = linear_sample(half_pixel(y - y1, scale_y), padded_size);
    for (int x = mask.x; x < mask.x + mask.width; ++x) {
      const LinearSample column = linear_sample(half_pixel(x - x1, scale_x), padded_size);
      const float upper = (1.0F - column.fraction) * value(row.low, column.low) +
                          column.fraction * value(row.low, column.high);
      const float lower = (1.0F - column.fraction) * value(row.high, column.low) +
                          column.fraction * value(row.high, column.high);
      *out++ = (1.0F - row.fraction) * upper + row.fraction * lower > threshold ? 1 : 0;
    }
  }
}

}  // namespace penumbra::nn
