// ResNet with bottleneck blocks (v1.5: the stride sits in the 3 x 3 convolution), batch norm folded.
//
//   stem:   7 x 7 convolution, stride 2, 64 channels, ReLU; 3 x 3 max pool, stride 2
//   block:  y = relu( x' + conv1x1(relu(conv3x3(relu(conv1x1(x))))) ),  x' = x or conv1x1(x) where the shape
//   changes C2..C5: outputs of the four stages; strides 4, 8, 16, 32; 256, 512, 1024, 2048 channels
//
// Source: He et al. 2016, Deep Residual Learning; torchvision.models.resnet.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nn/layers/conv2d.h"
#include "nn/models/weight_reader.h"

namespace penumbra::nn {

constexpr std::array<int, 4> kResNet50Blocks{3, 4, 6, 3};
constexpr std::array<int, 4> kResNetChannels{256, 512, 1024, 2048};  // of C2..C5

class ResNet {
 public:
  // Border that the image's feature map should have, so that the stem need not copy it.
  static constexpr int kImageBorder = 3;

  ResNet() = default;
  // Reads `prefix`conv1, bn1, layer1..layer4.
  ResNet(WeightReader& weights, const std::string& prefix, const std::array<int, 4>& blocks,
         float batch_norm_eps);

  // `image` is [1, 3, H, W] in blocks of 4; returns C2..C5.
  std::array<FeatureMap, 4> operator()(const FeatureMap& image, Arena& arena) const;

 private:
  struct Bottleneck {
    Conv2d conv1, conv2, conv3;
    std::optional<Conv2d> downsample;
  };
  Conv2d stem_;
  std::array<std::vector<Bottleneck>, 4> stages_;
};

}  // namespace penumbra::nn
