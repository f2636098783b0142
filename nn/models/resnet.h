// ResNet of basic or bottleneck blocks (v1.5: a bottleneck's stride sits in its 3 x 3 convolution), batch
// norm folded.
//
//   stem:        7 x 7 convolution, stride 2, w channels, ReLU; 3 x 3 max pool, stride 2
//   basic:       y = relu( x' + conv3x3(relu(conv3x3(x))) )
//   bottleneck:  y = relu( x' + conv1x1(relu(conv3x3(relu(conv1x1(x))))) )
//                x' = x, or conv1x1(x) where the shape changes
//   stage n:     blocks whose 3 x 3 convolutions have 2^(n-1) w channels; a bottleneck's output has 4 times
//                as many
//   C2..C5:      outputs of stages 1..4; strides 4, 8, 16, 32
//
//   depth  blocks of   stages 1..4
//   18     basic       2  2  2  2
//   34     basic       3  4  6  3
//   50     bottleneck  3  4  6  3
//   101    bottleneck  3  4 23  3
//   152    bottleneck  3  8 36  3        w is 64 times the width multiplier
//
// Source: He et al. 2016, Deep Residual Learning, table 1; torchvision.models.resnet.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nn/layers/conv2d.h"
#include "nn/models/weight_reader.h"

namespace penumbra::nn {

struct ResNetShape {
  int depth = 50;  // one of the table
  int width = 64;  // channels of the stem
};

// What the weights under `prefix` come closest to: blocks by the names of their tensors, width by the stem's
// shape. What they lack of it, or have beyond it, is noted when the network reads them.
ResNetShape resnet_shape(const WeightReader& weights, const std::string& prefix);

class ResNet {
 public:
  // Border that the image's feature map should have, so that the stem need not copy it.
  static constexpr int kImageBorder = 3;

  ResNet() = default;
  // Reads `prefix`conv1, bn1, layer1..layer4. Throws InputError for a depth that is not in the table.
  ResNet(WeightReader& weights, const std::string& prefix, const ResNetShape& shape, float batch_norm_eps);

  const ResNetShape& shape() const { return shape_; }
  const std::array<int, 4>& channels() const { return channels_; }  // of C2..C5

  // Of the convolutions, for an image of height x width pixels, multiples of 32.
  double multiply_adds(int height, int width) const;

  // `image` is [1, 3, H, W] in blocks of 4, and given back when the stem has read it; returns C2..C5: as the
  // next stage reads them, and C5 in the numbers of `last`, where a stage's last layer can store them so
  // (conv2d.h: on a tile unit, and bf16 where it is Winograd's on AVX-512), else in f32.
  std::array<FeatureMap, 4> operator()(FeatureMap image, Arena& arena, const Numbers& last = {}) const;

 private:
  struct Block {
    std::vector<Conv2d> convolutions;  // 2 of a basic block, 3 of a bottleneck; the last adds x'
    std::optional<Conv2d> downsample;
  };
  // `last` is x where nobody reads it afterwards, else null.
  FeatureMap apply(const Block& block, const FeatureMap& x, FeatureMap* last, Arena& arena,
                   const Numbers& output_numbers) const;
  Numbers input_numbers(std::size_t stage, std::size_t block) const {
    return stages_[stage][block].convolutions.front().input_numbers();
  }

  ResNetShape shape_;
  std::array<int, 4> channels_{};
  bool bottleneck_ = true;
  Conv2d stem_;
  std::array<std::vector<Block>, 4> stages_;
};

}  // namespace penumbra::nn
