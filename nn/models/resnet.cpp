#include "nn/models/resnet.h"

#include <fmt/format.h>

#include "nn/layers/pooling.h"

namespace penumbra::nn {

namespace {

constexpr int kStemChannels = 64;
constexpr int kExpansion = 4;  // output channels of a bottleneck per channel of its 3 x 3 convolution

struct ConvolutionShape {
  int outputs, inputs, kernel, stride;
};

// A convolution without bias and the batch norm behind it, as one.
Conv2d folded_convolution(WeightReader& weights, const std::string& convolution, const std::string& norm,
                          ConvolutionShape shape, Activation activation, float eps,
                          int input_block = kBlock) {
  FoldedConvolution folded = fold_batch_norm(
      weights.tensor(convolution + ".weight", {shape.outputs, shape.inputs, shape.kernel, shape.kernel}),
      weights.batch_norm(norm, shape.outputs, eps));
  Conv2dOptions options;
  options.stride = shape.stride;
  options.padding = shape.kernel / 2;
  options.activation = activation;
  return {folded.weight, folded.bias, options, input_block};
}

}  // namespace

ResNet::ResNet(WeightReader& weights, const std::string& prefix, const std::array<int, 4>& blocks,
               float batch_norm_eps) {
  stem_ = folded_convolution(weights, prefix + "conv1", prefix + "bn1", {kStemChannels, 3, 7, 2},
                             Activation::relu, batch_norm_eps, kImageBlock);
  int inputs = kStemChannels;
  for (std::size_t stage = 0; stage < 4; ++stage) {
    const int outputs = kResNetChannels[stage], middle = outputs / kExpansion;
    for (int b = 0; b < blocks[stage]; ++b) {
      const std::string name = fmt::format("{}layer{}.{}.", prefix, stage + 1, b);
      const int stride = b == 0 && stage > 0 ? 2 : 1;
      const auto convolution = [&](const char* conv, const char* norm, ConvolutionShape shape,
                                   Activation activation) {
        return folded_convolution(weights, name + conv, name + norm, shape, activation, batch_norm_eps);
      };
      Bottleneck block;
      block.conv1 = convolution("conv1", "bn1", {middle, inputs, 1, 1}, Activation::relu);
      block.conv2 = convolution("conv2", "bn2", {middle, middle, 3, stride}, Activation::relu);
      block.conv3 = convolution("conv3", "bn3", {outputs, middle, 1, 1}, Activation::relu);
      if (b == 0) {
        block.downsample =
            convolution("downsample.0", "downsample.1", {outputs, inputs, 1, stride}, Activation::none);
      }
      stages_[stage].push_back(std::move(block));
      inputs = outputs;
    }
  }
}

std::array<FeatureMap, 4> ResNet::operator()(const FeatureMap& image, Arena& arena) const {
  FeatureMap x = max_pool(stem_(image, arena), {3, 2, 1}, arena);
  std::array<FeatureMap, 4> outputs;
  for (std::size_t stage = 0; stage < 4; ++stage) {
    const FeatureMap* input = stage == 0 ? &x : &outputs[stage - 1];
    FeatureMap y;
    for (const Bottleneck& block : stages_[stage]) {
      FeatureMap shortcut;
      if (block.downsample) shortcut = (*block.downsample)(*input, arena);
      FeatureMap inner = block.conv2(block.conv1(*input, arena, 1), arena);
      y = block.conv3(inner, arena, 0, block.downsample ? &shortcut : input);
      input = &y;
    }
    outputs[stage] = std::move(y);
    if (stage == 0) x = FeatureMap();  // give its memory back
  }
  return outputs;
}

}  // namespace penumbra::nn
