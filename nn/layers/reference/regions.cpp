// Naive roi_align, batched_nms and paste_mask.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

namespace {

// Bilinear value of channel c at (y, x): 0 more than one pixel outside, clamped to the map otherwise.
double bilinear(const Tensor& map, std::int64_t c, float y, float x) {
  const auto height = map.extent(2), width = map.extent(3);
  if (y < -1.0F || x < -1.0F || y > static_cast<float>(height) || x > static_cast<float>(width)) return 0.0;
  y = std::clamp(y, 0.0F, static_cast<float>(height - 1));
  x = std::clamp(x, 0.0F, static_cast<float>(width - 1));
  const auto y0 = static_cast<std::int64_t>(y), x0 = static_cast<std::int64_t>(x);
  const std::int64_t y1 = std::min(y0 + 1, height - 1), x1 = std::min(x0 + 1, width - 1);
  const double fy = y - static_cast<float>(y0), fx = x - static_cast<float>(x0);
  return (1 - fy) * ((1 - fx) * map.at(0, c, y0, x0) + fx * map.at(0, c, y0, x1)) +
         fy * ((1 - fx) * map.at(0, c, y1, x0) + fx * map.at(0, c, y1, x1));
}

}  // namespace

Tensor roi_align(const Tensor& map, float scale, std::span<const Box> regions,
                 const RoiAlignOptions& options) {
  const int size = options.size;
  const float shift = options.aligned ? 0.5F : 0.0F, least = options.aligned ? -INFINITY : 1.0F;
  Tensor y({static_cast<std::int64_t>(regions.size()), map.extent(1), size, size});
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const float x1 = regions[r].x1 * scale, y1 = regions[r].y1 * scale;
    const float bin_w = std::max(regions[r].x2 * scale - x1, least) / static_cast<float>(size);
    const float bin_h = std::max(regions[r].y2 * scale - y1, least) / static_cast<float>(size);
    const auto samples = [&](float bin) {
      return options.sampling > 0 ? options.sampling : static_cast<int>(std::max(std::ceil(bin), 0.0F));
    };
    const int samples_y = samples(bin_h), samples_x = samples(bin_w);
    for (std::int64_t c = 0; c < map.extent(1); ++c) {
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
          double sum = 0.0;
          for (int u = 0; u < samples_y; ++u) {
            for (int v = 0; v < samples_x; ++v) {
              const float sub_y = (static_cast<float>(u) + 0.5F) * bin_h / static_cast<float>(samples_y);
              const float sub_x = (static_cast<float>(v) + 0.5F) * bin_w / static_cast<float>(samples_x);
              sum += bilinear(map, c, y1 - shift + static_cast<float>(i) * bin_h + sub_y,
                              x1 - shift + static_cast<float>(j) * bin_w + sub_x);
            }
          }
          y.at(static_cast<std::int64_t>(r), c, i, j) =
              static_cast<float>(sum / std::max(samples_y * samples_x, 1));
        }
      }
    }
  }
  return y;
}

std::vector<int> batched_nms(std::span<const Box> boxes, std::span<const float> scores,
                             std::span<const int> groups, float threshold, int max_kept) {
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return scores[static_cast<std::size_t>(a)] > scores[static_cast<std::size_t>(b)];
  });
  std::vector<bool> suppressed(boxes.size(), false);
  std::vector<int> kept;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const auto i = static_cast<std::size_t>(order[a]);
    if (suppressed[i]) continue;
    kept.push_back(order[a]);
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      const auto j = static_cast<std::size_t>(order[b]);
      if (groups[i] == groups[j] && iou(boxes[i], boxes[j]) > threshold) suppressed[j] = true;
    }
  }
  if (static_cast<int>(kept.size()) > max_kept) kept.resize(static_cast<std::size_t>(max_kept));
  return kept;
}

std::vector<std::uint8_t> paste_mask(std::span<const float> probabilities, int size, const Box& box,
                                     int image_width, int image_height, float threshold) {
  // The map with its border of zeros, as a tensor, so that bilinear() above can read it.
  const int padded = size + 2;
  Tensor map({1, 1, padded, padded});
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      map.at(0, 0, i + 1, j + 1) = probabilities[static_cast<std::size_t>(i * size + j)];
    }
  }
  const float growth = static_cast<float>(padded) / static_cast<float>(size);
  const float half_w = (box.x2 - box.x1) * 0.5F * growth, half_h = (box.y2 - box.y1) * 0.5F * growth;
  const float centre_x = (box.x1 + box.x2) * 0.5F, centre_y = (box.y1 + box.y2) * 0.5F;
  const int x1 = static_cast<int>(centre_x - half_w), x2 = static_cast<int>(centre_x + half_w);
  const int y1 = static_cast<int>(centre_y - half_h), y2 = static_cast<int>(centre_y + half_h);
  const float step_x = static_cast<float>(padded) / static_cast<float>(std::max(x2 - x1 + 1, 1));
  const float step_y = static_cast<float>(padded) / static_cast<float>(std::max(y2 - y1 + 1, 1));

  std::vector<std::uint8_t> mask(
      static_cast<std::size_t>(image_width) * static_cast<std::size_t>(image_height), 0);
  for (int y = std::max(y1, 0); y <= std::min(std::max(y2, y1), image_height - 1); ++y) {
    for (int x = std::max(x1, 0); x <= std::min(std::max(x2, x1), image_width - 1); ++x) {
      const float row = (static_cast<float>(y - y1) + 0.5F) * step_y - 0.5F;
      const float column = (static_cast<float>(x - x1) + 0.5F) * step_x - 0.5F;
      const double value = bilinear(map, 0, std::max(row, 0.0F), std::max(column, 0.0F));
      mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_width) +
           static_cast<std::size_t>(x)] = value > static_cast<double>(threshold) ? 1 : 0;
    }
  }
  return mask;
}

}  // namespace penumbra::nn::reference
