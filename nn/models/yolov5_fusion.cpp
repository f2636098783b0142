#include "nn/models/yolov5_fusion.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "nn/layers/pooling.h"

namespace penumbra::nn {

namespace {

constexpr PoolOptions kHalf{3, 2, 1};

}  // namespace

Yolov5Fusion::Yolov5Fusion(WeightReader& weights, const Yolov5Shape& shape) : masks_(shape.masks) {
  for (std::size_t l = 0; l < 3; ++l) {
    const int channels = shape.channels[2 + l];
    std::vector<Tensor> lambda;
    std::vector<float> bias;
    for (std::size_t k = 0; k < 3; ++k) {
      const int inputs = shape.channels[2 + k];
      const std::string name = fmt::format("asff.{}.resize.{}", l, k);
      if (k > l) levels_[l].resize[k] = yolov5_conv(weights, name, {inputs, channels});
      if (k < l) levels_[l].resize[k] = yolov5_conv(weights, name, {inputs, channels, 3, 2});
      const std::string weight = fmt::format("asff.{}.weight.{}", l, k);
      lambda.push_back(weights.tensor(weight + ".weight", {1, channels, 1, 1}));
      bias.push_back(weights.vector(weight + ".bias", 1).front());
    }
    levels_[l].mix = Asff(lambda, std::move(bias));
  }
}

std::array<FeatureMap, 3> Yolov5Fusion::operator()(const std::array<FeatureMap, 3>& maps,
                                                   Arena& arena) const {
  std::array<FeatureMap, 3> fused;
  for (std::size_t l = 0; l < 3; ++l) {
    std::array<FeatureMap, 3> resized;
    std::array<const FeatureMap*, 3> inputs{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Conv2d& resize = levels_[l].resize[k];
      if (k + 2 == l) {
        resized[k] = resize(max_pool(maps[k], kHalf, arena, 1), arena);
      } else if (k != l) {
        resized[k] = resize(maps[k], arena);
      }
      inputs[k] = k == l ? &maps[k] : &resized[k];
    }
    fused[l] = levels_[l].mix(inputs, arena, l == 0 && masks_ ? 1 : 0);
  }
  return fused;
}

}  // namespace penumbra::nn
