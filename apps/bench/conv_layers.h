// The convolutions of Mask R-CNN R50-FPN as benchmarks time them, on numbers that have no meaning.
#pragma once

#include <string>
#include <vector>

#include "nn/layers/conv2d.h"

namespace penumbra::apps {

struct ConvShape {
  std::string name;
  int images, channels, outputs, height, width;  // of the input
  int kernel, stride;
  bool residual = false;
  int times = 1;  // in backbone and pyramid
};

// The layers of ResNet-50 and its pyramid for a network input of height x width, and two of the heads.
std::vector<ConvShape> network_shapes(int height, int width);
// Nine of them, which other engines are compared on: the three of a bottleneck in stages 2, 3 and 4.
std::vector<ConvShape> compared_shapes(int height, int width);

// A layer with its input and output in the numbers that it reads best: on a tile unit its own, bf16 of
// Winograd's on AVX-512, else f32.
class ConvLayer {
 public:
  ConvLayer(const ConvShape& shape, nn::Precision precision);

  void run();
  const char* algorithm() const { return conv_.algorithm(); }
  double gflop() const;     // of the direct convolution, whatever the method
  double mb_moved() const;  // inputs, weights, outputs and what is added to them

 private:
  ConvShape shape_;
  nn::Conv2d conv_;
  nn::Arena arena_;
  nn::FeatureMap input_, residual_;
  double outputs_ = 0.0;  // values
};

}  // namespace penumbra::apps
