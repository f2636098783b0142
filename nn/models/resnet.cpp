#include "nn/models/resnet.h"

#include <fmt/format.h>

#include <cstdlib>
#include <span>
#include <utility>

#include "nn/base/error.h"
#include "nn/layers/pooling.h"

namespace penumbra::nn {

namespace {

constexpr int kWidestStem = 1024;  // wider ones are damaged files, whose network would not fit into memory
constexpr int kExpansion = 4;      // output channels of a bottleneck per channel of its 3 x 3 convolution

struct Variant {
  int depth;
  bool bottleneck;
  std::array<int, 4> blocks;
};

constexpr std::array<Variant, 5> kVariants{{{18, false, {2, 2, 2, 2}},
                                            {34, false, {3, 4, 6, 3}},
                                            {50, true, {3, 4, 6, 3}},
                                            {101, true, {3, 4, 23, 3}},
                                            {152, true, {3, 8, 36, 3}}}};

const Variant& variant_of(int depth) {
  for (const Variant& variant : kVariants) {
    if (variant.depth == depth) return variant;
  }
  throw InputError("ResNet", "a depth of 18, 34, 50, 101 or 152", fmt::format("{}", depth));
}

struct ConvolutionShape {
  int outputs, inputs, kernel, stride;
};

// A convolution without bias and the batch norm behind it, as one.
Conv2d folded_convolution(WeightReader& weights, const std::string& convolution, const std::string& norm,
                          ConvolutionShape shape, Activation activation, float eps,
                          int input_block = kBlock) {
  const FoldedConvolution folded =
      weights.folded(convolution, {shape.outputs, shape.inputs, shape.kernel, shape.kernel}, norm, eps);
  Conv2dOptions options;
  options.stride = shape.stride;
  options.padding = shape.kernel / 2;
  options.activation = activation;
  options.format = input_block == kBlock ? weights.format(convolution) : weights.uncalibrated_format();
  return {folded.weight, folded.bias, options, input_block};
}

}  // namespace

ResNetShape resnet_shape(const WeightReader& weights, const std::string& prefix) {
  ResNetShape shape;
  const Shape stem = weights.shape(prefix + "conv1.weight");
  if (stem.size() == 4 && stem.front() > 0 && stem.front() <= kWidestStem)
    shape.width = static_cast<int>(stem.front());

  const std::string first = prefix + "layer1.0.";
  const bool bottleneck = weights.has(first + "conv3.weight") || !weights.has(first + "conv2.weight");
  std::array<int, 4> blocks{};
  for (std::size_t stage = 0; stage < 4; ++stage) {
    while (weights.has(fmt::format("{}layer{}.{}.conv1.weight", prefix, stage + 1, blocks[stage]))) {
      ++blocks[stage];
    }
  }
  int least = 0;
  bool found = false;
  for (const Variant& variant : kVariants) {
    if (variant.bottleneck != bottleneck) continue;
    int difference = 0;
    for (std::size_t stage = 0; stage < 4; ++stage) {
      difference += std::abs(variant.blocks[stage] - blocks[stage]);
    }
    if (found && difference >= least) continue;
    found = true;
    least = difference;
    shape.depth = variant.depth;
  }
  return shape;
}

ResNet::ResNet(WeightReader& weights, const std::string& prefix, const ResNetShape& shape,
               float batch_norm_eps)
    : shape_(shape) {
  const Variant& variant = variant_of(shape.depth);
  bottleneck_ = variant.bottleneck;
  stem_ = folded_convolution(weights, prefix + "conv1", prefix + "bn1", {shape.width, 3, 7, 2},
                             Activation::relu, batch_norm_eps, kImageBlock);
  int inputs = shape.width;
  for (std::size_t stage = 0; stage < 4; ++stage) {
    const int middle = shape.width << stage, outputs = bottleneck_ ? middle * kExpansion : middle;
    channels_[stage] = outputs;
    for (int b = 0; b < variant.blocks[stage]; ++b) {
      const std::string name = fmt::format("{}layer{}.{}.", prefix, stage + 1, b);
      const int stride = b == 0 && stage > 0 ? 2 : 1;
      Block block;
      const auto add = [&](ConvolutionShape convolution) {
        const std::size_t index = block.convolutions.size() + 1;
        block.convolutions.push_back(folded_convolution(weights, fmt::format("{}conv{}", name, index),
                                                        fmt::format("{}bn{}", name, index), convolution,
                                                        Activation::relu, batch_norm_eps));
      };
      if (bottleneck_) {
        add({middle, inputs, 1, 1});
        add({middle, middle, 3, stride});
        add({outputs, middle, 1, 1});
      } else {
        add({outputs, inputs, 3, stride});
        add({outputs, outputs, 3, 1});
      }
      if (stride != 1 || inputs != outputs) {
        block.downsample = folded_convolution(weights, name + "downsample.0", name + "downsample.1",
                                              {outputs, inputs, 1, stride}, Activation::none, batch_norm_eps);
      }
      stages_[stage].push_back(std::move(block));
      inputs = outputs;
    }
  }
}

double ResNet::multiply_adds(int height, int width) const {
  double sum = stem_.multiply_adds(height, width);
  for (std::size_t stage = 0; stage < stages_.size(); ++stage) {
    const int h = height >> (stage + 2), w = width >> (stage + 2);  // of the stage's output
    for (const Block& block : stages_[stage]) {
      // The first block of a later stage halves the map: in its 3 x 3 convolution, and beside it.
      const int step = stage > 0 && &block == &stages_[stage].front() ? 2 : 1;
      const std::size_t halving = bottleneck_ ? 1 : 0;
      for (std::size_t k = 0; k < block.convolutions.size(); ++k) {
        const int scale = k <= halving ? step : 1;
        sum += block.convolutions[k].multiply_adds(h * scale, w * scale);
      }
      if (block.downsample) sum += block.downsample->multiply_adds(h * step, w * step);
    }
  }
  return sum;
}

FeatureMap ResNet::apply(const Block& block, const FeatureMap& x, FeatureMap* last, Arena& arena,
                         const Numbers& output_numbers) const {
  // Maps that a 3 x 3 convolution reads get a border of 1.
  FeatureMap inner = block.convolutions[0](x, arena, 1, nullptr, block.convolutions[1].input_numbers());
  if (bottleneck_) {
    inner = block.convolutions[1](std::move(inner), arena, 0, nullptr, block.convolutions[2].input_numbers());
  }
  const Conv2d& convolution = block.convolutions.back();
  const int border = bottleneck_ ? 0 : 1;
  if (!block.downsample && last == nullptr)
    return convolution(std::move(inner), arena, border, &x, output_numbers);
  // Made late, when the block's widest maps are no more; the sum takes its place.
  FeatureMap shortcut =
      block.downsample ? (*block.downsample)(x, arena, 0, nullptr, {Precision::bf16, {}}) : std::move(*last);
  return convolution.onto(std::move(shortcut), std::move(inner), arena, border, output_numbers);
}

std::array<FeatureMap, 4> ResNet::operator()(FeatureMap image, Arena& arena, const Numbers& last) const {
  FeatureMap x = stem_(image, arena, 0, nullptr, input_numbers(0, 0));
  image = FeatureMap();  // here and below: gives its memory back
  x = max_pool(x, {3, 2, 1}, arena, bottleneck_ ? 0 : 1);
  std::array<FeatureMap, 4> outputs;
  for (std::size_t stage = 0; stage < 4; ++stage) {
    const FeatureMap* input = stage == 0 ? &x : &outputs[stage - 1];
    FeatureMap y;
    for (std::size_t b = 0; b < stages_[stage].size(); ++b) {
      const bool end = b + 1 == stages_[stage].size();
      const Numbers next =
          end ? (stage < 3 ? input_numbers(stage + 1, 0) : last) : input_numbers(stage, b + 1);
      y = apply(stages_[stage][b], *input, b > 0 ? &y : nullptr, arena, next);
      input = &y;
    }
    outputs[stage] = std::move(y);
    if (stage == 0) x = FeatureMap();
  }
  return outputs;
}

}  // namespace penumbra::nn
