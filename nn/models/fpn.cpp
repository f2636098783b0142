#include "nn/models/fpn.h"

#include <fmt/format.h>

#include "nn/layers/pooling.h"
#include "nn/layers/upsample.h"

namespace penumbra::nn {

FeaturePyramid::FeaturePyramid(WeightReader& weights, const std::string& prefix,
                               const std::array<int, 4>& stage_channels, bool attention) {
  if (!attention) weights.ignore(prefix + "attention.");
  attention = attention && weights.has(prefix + "attention.0.spatial.weight");
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const std::string inner = fmt::format("{}inner_blocks.{}.0.", prefix, k);
    const std::string outer = fmt::format("{}layer_blocks.{}.0.", prefix, k);
    Level& level = levels_[k];
    level.lateral = Conv2d(weights.tensor(inner + "weight", {kPyramidChannels, stage_channels[k], 1, 1}),
                           weights.vector(inner + "bias", kPyramidChannels), {});
    Conv2dOptions options;
    options.padding = 1;
    level.output = Conv2d(weights.tensor(outer + "weight", {kPyramidChannels, kPyramidChannels, 3, 3}),
                          weights.vector(outer + "bias", kPyramidChannels), options);
    if (!attention) continue;
    const std::string name = fmt::format("{}attention.{}.", prefix, k);
    const Shape reduce = weights.shape(name + "channel.reduce.weight");
    const std::int64_t hidden = reduce.empty() ? kPyramidChannels / 16 : reduce.front();
    level.attention = MixedAttention(
        SpatialAttention(weights.tensor(name + "spatial.weight", {1, 2, 7, 7})),
        ChannelAttention(weights.tensor(name + "channel.reduce.weight", {hidden, kPyramidChannels}),
                         weights.tensor(name + "channel.expand.weight", {kPyramidChannels, hidden})));
  }
}

std::array<FeatureMap, kPyramidLevels> FeaturePyramid::operator()(std::array<FeatureMap, 4> stages,
                                                                  Arena& arena) const {
  std::array<FeatureMap, kPyramidLevels> pyramid;
  FeatureMap top_down;  // T_{n+1}
  for (std::size_t k = levels_.size(); k-- > 0;) {
    const Level& level = levels_[k];
    FeatureMap lateral = level.lateral(stages[k], arena, 1);
    stages[k] = FeatureMap();  // gives its memory back
    if (level.attention) level.attention->apply(lateral, arena);
    if (k + 1 < levels_.size()) add_upsampled(top_down, lateral);
    top_down = std::move(lateral);
    pyramid[k] = level.output(top_down, arena, 1);
  }
  pyramid[4] = subsample(pyramid[3], 2, arena, 1);
  return pyramid;
}

}  // namespace penumbra::nn
