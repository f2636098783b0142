#include "nn/models/mask_head.h"

#include <fmt/format.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/layers/activations.h"
#include "nn/layers/narrow_maps.h"

namespace penumbra::nn {

namespace {

constexpr std::size_t kDetectionsPerPass = 16;  // that pass the layers together: 17 MB

}  // namespace

MaskHead::MaskHead(WeightReader& weights, const std::string& prefix, int channels, int classes,
                   const MaskHeadConfig& config)
    : config_(config) {
  if (config.layers > MaskHeadConfig::kMostLayers) {
    throw InputError("mask head", fmt::format("at most {} layers", MaskHeadConfig::kMostLayers),
                     fmt::format("{}", config.layers));
  }
  Conv2dOptions options;
  options.padding = 1;
  options.activation = Activation::relu;
  for (int i = 0; i < config.layers; ++i) {
    const std::string name = fmt::format("{}mask_head.{}.0.", prefix, i);
    options.format = weights.format(fmt::format("{}mask_head.{}", prefix, i));
    convolutions_.emplace_back(weights.tensor(name + "weight", {channels, channels, 3, 3}),
                               weights.vector(name + "bias", channels), options);
  }
  const std::string predictor = prefix + "mask_predictor.";
  ConvTranspose2dOptions doubling;
  doubling.stride = 2;
  doubling.activation = Activation::relu;
  doubling.format = weights.format(predictor + "conv5_mask");
  upsample_ = ConvTranspose2d(weights.tensor(predictor + "conv5_mask.weight", {channels, channels, 2, 2}),
                              weights.vector(predictor + "conv5_mask.bias", channels), doubling);
  logit_weight_ = weights.tensor(predictor + "mask_fcn_logits.weight", {classes, channels, 1, 1});
  logit_bias_ = weights.vector(predictor + "mask_fcn_logits.bias", classes);
}

ArenaVector<float> MaskHead::operator()(std::span<const PyramidLevel> pyramid,
                                        const ArenaVector<ScoredBox>& detections, Arena& arena) const {
  ArenaVector<float> probabilities(
      arena, detections.capacity() * static_cast<std::size_t>(mask_size() * mask_size()));
  PreparedLayers prepared;
  for (std::size_t i = 0; i < convolutions_.size(); ++i) prepared[i] = convolutions_[i].prepare(arena);
  // Passes without detections run too, so that all pictures of a shape ask for the same memory.
  for (std::size_t first = 0; first < detections.capacity(); first += kDetectionsPerPass) {
    const std::size_t capacity = std::min(kDetectionsPerPass, detections.capacity() - first);
    const std::size_t begin = std::min(first, detections.size());
    const std::size_t count = std::min(capacity, detections.size() - begin);
    predict(pyramid, detections.span().subspan(begin, count), static_cast<int>(capacity), prepared,
            probabilities, arena);
  }
  return probabilities;
}

void MaskHead::predict(std::span<const PyramidLevel> pyramid, std::span<const ScoredBox> detections,
                       int capacity, const PreparedLayers& prepared, ArenaVector<float>& probabilities,
                       Arena& arena) const {
  ArenaVector<Box> regions(arena, static_cast<std::size_t>(capacity));
  for (const ScoredBox& detection : detections) regions.push_back(detection.box);
  const auto numbers = [&](std::size_t layer) {
    return layer < convolutions_.size() ? convolutions_[layer].input_numbers() : upsample_.input_numbers();
  };
  FeatureMap features =
      multi_scale_roi_align(pyramid, regions.span(), config_.roi_align, arena, 1, capacity, numbers(0));
  for (std::size_t i = 0; i < convolutions_.size(); ++i) {
    features = convolutions_[i](features, arena, prepared[i], 1, nullptr, numbers(i + 1));
  }
  const bool narrow = upsample_.input_numbers().precision != Precision::f32;
  features = upsample_(features, arena, 0, {narrow ? Precision::bf16 : Precision::f32, {}});

  const int size = mask_size();
  const std::size_t start = probabilities.size();
  probabilities.resize(start + detections.size() * static_cast<std::size_t>(size * size));
  parallel_for(detections.size(), 1, [&](std::size_t d) {
    const auto label = static_cast<std::size_t>(detections[d].label);
    const float* weight =
        logit_weight_.values.data() + label * static_cast<std::size_t>(logit_weight_.extent(1));
    float* out = probabilities.data() + start + d * static_cast<std::size_t>(size * size);
    for (int y = 0; y < size; ++y) {
      if (narrow) {
        dot_row(features, static_cast<int>(d), y, weight, out);
        for (int x = 0; x < size; ++x, ++out) *out = sigmoid(*out + logit_bias_[label]);
        continue;
      }
      for (int x = 0; x < size; ++x) {
        float lanes[kBlock] = {};
        for (int b = 0; b < features.blocks(); ++b) {
          const float* f = features.pixel(static_cast<int>(d), b, y, x);
          for (int c = 0; c < kBlock; ++c) lanes[c] += weight[b * kBlock + c] * f[c];
        }
        float logit = logit_bias_[label];
        for (const float lane : lanes) logit += lane;
        *out++ = sigmoid(logit);
      }
    }
  });
}

}  // namespace penumbra::nn
