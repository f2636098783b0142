#include "nn/models/rpn.h"

#include <algorithm>

#include "nn/layers/activations.h"
#include "nn/layers/anchor_generator.h"
#include "nn/layers/best_scores.h"
#include "nn/layers/box_coder.h"
#include "nn/layers/nms.h"

namespace penumbra::nn {

namespace {

// Rows of `b` under those of `a`, for two weights that read the same input.
Tensor stack_rows(const Tensor& a, const Tensor& b) {
  Tensor stacked = a;
  stacked.shape[0] += b.shape[0];
  stacked.values.insert(stacked.values.end(), b.values.begin(), b.values.end());
  return stacked;
}

}  // namespace

RegionProposalNetwork::RegionProposalNetwork(WeightReader& weights, const std::string& prefix, int channels,
                                             const RpnConfig& config)
    : config_(config) {
  const int anchors = static_cast<int>(config.aspect_ratios.size());
  Conv2dOptions options;
  options.padding = 1;
  options.activation = Activation::relu;
  options.format = weights.format(prefix + "conv");
  conv_ = Conv2d(weights.tensor(prefix + "conv.0.0.weight", {channels, channels, 3, 3}),
                 weights.vector(prefix + "conv.0.0.bias", channels), options);
  std::vector<float> bias = weights.vector(prefix + "cls_logits.bias", anchors);
  const std::vector<float> delta_bias = weights.vector(prefix + "bbox_pred.bias", anchors * 4);
  bias.insert(bias.end(), delta_bias.begin(), delta_bias.end());
  Conv2dOptions predicting;
  predicting.format = weights.uncalibrated_format();
  predictor_ = Conv2d(stack_rows(weights.tensor(prefix + "cls_logits.weight", {anchors, channels, 1, 1}),
                                 weights.tensor(prefix + "bbox_pred.weight", {anchors * 4, channels, 1, 1})),
                      bias, predicting);
  for (std::size_t level = 0; level < anchors_.size(); ++level) {
    anchors_[level] = base_anchors(config.anchor_sizes[level], config.aspect_ratios);
  }
}

ArenaVector<Box> RegionProposalNetwork::operator()(std::span<const FeatureMap> pyramid,
                                                   const ImageExtent& image, Arena& arena) const {
  const auto most_proposals = static_cast<std::size_t>(std::max(config_.proposals, 0));
  ArenaVector<Box> proposals(arena, most_proposals);
  Candidates all(arena, pyramid.size() * static_cast<std::size_t>(std::max(config_.candidates_per_level, 0)));
  const ArenaBuffer prepared = conv_.prepare(arena);
  for (std::size_t level = 0; level < pyramid.size(); ++level) {
    const FeatureMap outputs =
        predictor_(conv_(pyramid[level], arena, prepared, 0, nullptr, predictor_.input_numbers()), arena);
    add_candidates(outputs, level, image, all, arena);
  }
  const NmsOptions options{config_.nms_threshold, config_.proposals, static_cast<int>(pyramid.size())};
  for (const int i : batched_nms(all, options, arena)) {
    proposals.push_back(all.boxes[static_cast<std::size_t>(i)]);
  }
  return proposals;
}

void RegionProposalNetwork::add_candidates(const FeatureMap& outputs, std::size_t level,
                                           const ImageExtent& image, Candidates& candidates,
                                           Arena& arena) const {
  constexpr int kAnchors = std::tuple_size_v<decltype(RpnConfig::aspect_ratios)>;
  static_assert(5 * kAnchors <= kBlock, "a pixel's outputs are one block");
  const int width = outputs.width();
  BestScores best(arena, static_cast<std::size_t>(std::max(config_.candidates_per_level, 0)));
  std::uint32_t index = 0;
  for (int y = 0; y < outputs.height(); ++y) {
    const float* pixel = outputs.pixel(0, 0, y, 0);
    for (int x = 0; x < width; ++x, pixel += kBlock) {
      for (int a = 0; a < kAnchors; ++a) best.offer(pixel[a], index++);
    }
  }

  const auto stride_x = static_cast<float>(image.padded_width / width);
  const auto stride_y = static_cast<float>(image.padded_height / outputs.height());
  for (const RankKey key : best.sorted()) {
    const auto i = static_cast<int>(index_of(key));
    const int a = i % kAnchors, x = i / kAnchors % width, y = i / kAnchors / width;
    const float* output = outputs.pixel(0, 0, y, x);
    const float* delta = output + kAnchors + 4 * a;
    const Box anchor = shift(anchors_[level][static_cast<std::size_t>(a)], static_cast<float>(x) * stride_x,
                             static_cast<float>(y) * stride_y);
    const Box box = clip(decode_box(anchor, delta[0], delta[1], delta[2], delta[3], {}),
                         static_cast<float>(image.width), static_cast<float>(image.height));
    // Written so that a NaN, which no comparison admits, is dropped too.
    if (!(box.width() >= config_.min_side && box.height() >= config_.min_side)) continue;
    candidates.add(box, sigmoid(output[a]), static_cast<int>(level));
  }
}

}  // namespace penumbra::nn
