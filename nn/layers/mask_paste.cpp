#include "nn/layers/mask_paste.h"

#include <algorithm>
#include <array>
#include <utility>

#include "nn/base/linear_sample.h"

namespace penumbra::nn {

namespace {

constexpr int kStrip = 256;  // pixels of a row that are worked on together

// Row `row` of the map with its border of zeros, at the columns.
void resize_row(std::span<const float> probabilities, int size, int row,
                std::span<const LinearSample> columns, float* out) {
  const auto value = [&](int column) {
    const bool inside = row >= 1 && column >= 1 && row <= size && column <= size;
    return inside ? probabilities[static_cast<std::size_t>((row - 1) * size + column - 1)] : 0.0F;
  };
  for (const LinearSample& column : columns) {
    *out++ = (1.0F - column.fraction) * value(column.low) + column.fraction * value(column.high);
  }
}

}  // namespace

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
  std::array<LinearSample, kStrip> columns;
  std::array<float, kStrip> lines[2];  // two rows of the map, resized along x
  for (int left = 0; left < mask.width; left += kStrip) {
    const int pixels = std::min(mask.width - left, kStrip);
    for (int i = 0; i < pixels; ++i) {
      columns[static_cast<std::size_t>(i)] =
          linear_sample(half_pixel(mask.x + left + i - x1, scale_x), padded_size);
    }
    int held[2] = {-1, -1};  // which rows these are
    // Row r and r + 1 lie in different lines, so that each is resized once, while r goes up.
    const auto line = [&](int row) {
      std::array<float, kStrip>& values = lines[row % 2];
      if (std::exchange(held[row % 2], row) != row) {
        resize_row(probabilities, size, row, std::span(columns).first(static_cast<std::size_t>(pixels)),
                   values.data());
      }
      return values.data();
    };
    for (int y = 0; y < mask.height; ++y) {
      const LinearSample row = linear_sample(half_pixel(mask.y + y - y1, scale_y), padded_size);
      const float *upper = line(row.low), *lower = line(row.high);
      std::uint8_t* out = mask.bits.data() + static_cast<std::ptrdiff_t>(y) * mask.width + left;
      for (int i = 0; i < pixels; ++i) {
        out[i] = (1.0F - row.fraction) * upper[i] + row.fraction * lower[i] > threshold;
      }
    }
  }
}

}  // namespace penumbra::nn
