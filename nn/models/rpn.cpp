#include "nn/models/rpn.h"

#include <algorithm>
#include <numeric>

#include "nn/layers/activations.h"
#include "nn/layers/anchor_generator.h"
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

// The `count` largest logits of a level as indices (pixel * anchors + anchor), largest first, equal ones in
// order.
ArenaVector<int> best_logits(const ArenaVector<float>& logits, int count, Arena& arena) {
  ArenaVector<int> order(arena, logits.capacity());
  order.resize(logits.size());
  std::iota(order.begin(), order.end(), 0);
  const auto better = [&](int a, int b) {
    const float la = logits[static_cast<std::size_t>(a)], lb = logits[static_cast<std::size_t>(b)];
    return la != lb ? la > lb : a < b;
  };
  const std::size_t kept = std::min(static_cast<std::size_t>(std::max(count, 0)), order.size());
  std::partial_sort(order.begin(), order.begin() + kept, order.end(), better);
  order.resize(kept);
  return order;
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
  const int anchors = static_cast<int>(config_.aspect_ratios.size());
  const auto most_proposals = static_cast<std::size_t>(std::max(config_.proposals, 0));
  ArenaVector<Box> proposals(arena, most_proposals);
  Candidates all(arena, pyramid.size() * static_cast<std::size_t>(std::max(config_.candidates_per_level, 0)));
  const ArenaBuffer prepared = conv_.prepare(arena);
  for (std::size_t level = 0; level < pyramid.size(); ++level) {
    const FeatureMap outputs =
        predictor_(conv_(pyramid[level], arena, prepared, 0, nullptr, predictor_.input_numbers()), arena);
    const int width = outputs.width();
    const auto stride_x = static_cast<float>(image.padded_width / width);
    const auto stride_y = static_cast<float>(image.padded_height / outputs.height());
    // Channel c of a pixel; the predictor has one channel block or a few.
    const auto output = [&](int pixel, int c) {
      return outputs.pixel(0, c / kBlock, pixel / width, pixel % width)[c % kBlock];
    };
    ArenaVector<float> logits(arena, static_cast<std::size_t>(outputs.height() * width * anchors));
    logits.resize(logits.capacity());
    float* next = logits.data();
    for (int y = 0; y < outputs.height(); ++y) {
      for (int x = 0; x < width; ++x) {
        for (int a = 0; a < anchors; ++a) *next++ = outputs.pixel(0, a / kBlock, y, x)[a % kBlock];
      }
    }
    for (const int i : best_logits(logits, config_.candidates_per_level, arena)) {
      const int pixel = i / anchors, a = i % anchors, delta = anchors + 4 * a;
      const Box anchor =
          shift(anchors_[level][static_cast<std::size_t>(a)], static_cast<float>(pixel % width) * stride_x,
                static_cast<float>(pixel / width) * stride_y);
      const Box box = clip(decode_box(anchor, output(pixel, delta), output(pixel, delta + 1),
                                      output(pixel, delta + 2), output(pixel, delta + 3), {}),
                           static_cast<float>(image.width), static_cast<float>(image.height));
      // Written so that a NaN, which no comparison admits, is dropped too.
      if (!(box.width() >= config_.min_side && box.height() >= config_.min_side)) continue;
      all.add(box, sigmoid(logits[static_cast<std::size_t>(i)]), static_cast<int>(level));
    }
  }
  const NmsOptions options{config_.nms_threshold, config_.proposals, static_cast<int>(pyramid.size())};
  for (const int i : batched_nms(all, options, arena)) {
    proposals.push_back(all.boxes[static_cast<std::size_t>(i)]);
  }
  return proposals;
}

}  // namespace penumbra::nn
