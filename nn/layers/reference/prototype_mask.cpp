#include <algorithm>
#include <cmath>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

std::vector<std::uint8_t> prototype_mask(const Tensor& prototypes, std::span<const float> weights,
                                         const PrototypeFrame& frame, const Box& box, int image_width,
                                         int image_height, float threshold) {
  const std::int64_t height = prototypes.extent(2), width = prototypes.extent(3);
  const auto probability = [&](std::int64_t i, std::int64_t j) {
    double sum = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      sum += static_cast<double>(weights[k]) * prototypes.at(0, static_cast<std::int64_t>(k), i, j);
    }
    return 1.0 / (1.0 + std::exp(-sum));
  };
  const auto position = [](int pixel, float scale, float offset, std::int64_t extent) {
    return std::clamp((pixel + 0.5) * scale + offset - 0.5, 0.0, static_cast<double>(extent - 1));
  };
  std::vector<std::uint8_t> mask;
  for (int y = 0; y < image_height; ++y) {
    const double v = position(y, frame.scale_y, frame.top, height);
    const auto i = static_cast<std::int64_t>(v), next_i = std::min(i + 1, height - 1);
    for (int x = 0; x < image_width; ++x) {
      const double u = position(x, frame.scale_x, frame.left, width);
      const auto j = static_cast<std::int64_t>(u), next_j = std::min(j + 1, width - 1);
      const double fv = v - static_cast<double>(i), fu = u - static_cast<double>(j);
      const double value = (1 - fv) * ((1 - fu) * probability(i, j) + fu * probability(i, next_j)) +
                           fv * ((1 - fu) * probability(next_i, j) + fu * probability(next_i, next_j));
      const auto px = static_cast<float>(x), py = static_cast<float>(y);
      const bool inside = px >= box.x1 && px < box.x2 && py >= box.y1 && py < box.y2;
      mask.push_back(inside && value > threshold ? 1 : 0);
    }
  }
  return mask;
}

}  // namespace penumbra::nn::reference
