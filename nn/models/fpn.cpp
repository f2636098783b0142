#include "nn/models/fpn.h"

#include <fmt/format.h>

#include <utility>

#include "nn/base/error.h"
#include "nn/layers/narrow_maps.h"
#include "nn/layers/pooling.h"
#include "nn/layers/upsample.h"

namespace penumbra::nn {

namespace {

constexpr int kTorchvisionChannels = 256;
constexpr int kMostChannels = 1024;  // more is a damaged file, whose network would not fit into memory

int pyramid_channels(const WeightReader& weights, const std::string& prefix) {
  const Shape shape = weights.shape(prefix + "inner_blocks.0.0.weight");
  if (shape.empty()) return kTorchvisionChannels;  // missing: torchvision's, for the error's sake
  if (shape.front() < kBlock || shape.front() > kMostChannels || shape.front() % kBlock != 0) {
    throw InputError(weights.source() + ", " + prefix + "inner_blocks.0.0.weight",
                     fmt::format("a multiple of {} channels, at most {}", kBlock, kMostChannels),
                     to_string(shape));
  }
  return static_cast<int>(shape.front());
}

}  // namespace

FeaturePyramid::FeaturePyramid(WeightReader& weights, const std::string& prefix,
                               const std::array<int, 4>& stage_channels, bool attention) {
  channels_ = pyramid_channels(weights, prefix);
  if (!attention) weights.ignore(prefix + "attention.");
  attention = attention && weights.has(prefix + "attention.0.spatial.weight");
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const std::string inner = fmt::format("{}inner_blocks.{}.0.", prefix, k);
    const std::string outer = fmt::format("{}layer_blocks.{}.0.", prefix, k);
    Level& level = levels_[k];
    Conv2dOptions pointwise;
    pointwise.format = weights.format(fmt::format("{}inner_blocks.{}", prefix, k));
    level.lateral = Conv2d(weights.tensor(inner + "weight", {channels_, stage_channels[k], 1, 1}),
                           weights.vector(inner + "bias", channels_), pointwise);
    Conv2dOptions options;
    options.padding = 1;
    options.format = weights.format(fmt::format("{}layer_blocks.{}", prefix, k));
    level.output = Conv2d(weights.tensor(outer + "weight", {channels_, channels_, 3, 3}),
                          weights.vector(outer + "bias", channels_), options);
    if (!attention) continue;
    const std::string name = fmt::format("{}attention.{}.", prefix, k);
    const Shape reduce = weights.shape(name + "channel.reduce.weight");
    const std::int64_t hidden = reduce.empty() ? channels_ / 16 : reduce.front();
    level.attention =
        MixedAttention(SpatialAttention(weights.tensor(name + "spatial.weight", {1, 2, 7, 7})),
                       ChannelAttention(weights.tensor(name + "channel.reduce.weight", {hidden, channels_}),
                                        weights.tensor(name + "channel.expand.weight", {channels_, hidden})));
  }
}

double FeaturePyramid::multiply_adds(int height, int width) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const int h = height >> (k + 2), w = width >> (k + 2);
    sum += levels_[k].lateral.multiply_adds(h, w) + levels_[k].output.multiply_adds(h, w);
  }
  return sum;
}

std::array<FeatureMap, kPyramidLevels> FeaturePyramid::operator()(std::array<FeatureMap, 4> stages,
                                                                  Arena& arena,
                                                                  const Numbers& output_numbers) const {
  std::array<FeatureMap, kPyramidLevels> pyramid;
  FeatureMap top_down;  // T_{n+1}
  for (std::size_t k = levels_.size(); k-- > 0;) {
    const Level& level = levels_[k];
    const bool top = k + 1 == levels_.size();
    const Numbers numbers = level.attention ? Numbers{} : level.output.input_numbers();
    if (numbers.precision == Precision::f32) {
      FeatureMap lateral = level.lateral(std::move(stages[k]), arena, 1);
      stages[k] = FeatureMap();  // gives its memory back
      if (level.attention) level.attention->apply(lateral, arena);
      if (!top) add_upsampled(top_down, lateral);
      top_down = std::move(lateral);
    } else if (top) {
      top_down = level.lateral(std::move(stages[k]), arena, 1, nullptr, numbers);
      stages[k] = FeatureMap();
    } else {
      const FeatureMap lateral =
          level.lateral(std::move(stages[k]), arena, 0, nullptr, {Precision::bf16, {}});
      stages[k] = FeatureMap();
      top_down = sum_with_upsampled(lateral, top_down, numbers, arena, 1);
    }
    pyramid[k] = level.output(top_down, arena, 1, nullptr, output_numbers);
  }
  pyramid[4] = subsample(pyramid[3], 2, arena, 1);
  return pyramid;
}

}  // namespace penumbra::nn
