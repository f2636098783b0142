#include "nn/layers/anchor_generator.h"

#include <cmath>

namespace penumbra::nn {

std::vector<Box> base_anchors(float scale, std::span<const float> ratios) {
  std::vector<Box> anchors;
  for (const float ratio : ratios) {
    const float h_ratio = std::sqrt(ratio), w_ratio = 1.0F / h_ratio;
    const float w = w_ratio * scale, h = h_ratio * scale;
    // nearbyint rounds half to even, as torch.round does.
    anchors.push_back(
        {std::nearbyint(-w / 2), std::nearbyint(-h / 2), std::nearbyint(w / 2), std::nearbyint(h / 2)});
  }
  return anchors;
}

}  // namespace penumbra::nn
