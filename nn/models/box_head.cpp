#include "nn/models/box_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "nn/layers/activations.h"
#include "nn/layers/box_coder.h"

namespace penumbra::nn {

namespace {

constexpr int kTorchvisionHidden = 1024;  // width of the fully connected layers
constexpr int kMostHidden = 8192;         // more is a damaged file
// Proposals that pass the layers together: enough to read the 51 MB of fc6's weights seldom, few enough that
// the regions (25 MB) do not decide how much memory the network needs.
constexpr std::size_t kProposalsPerPass = 500;
constexpr BoxCoderWeights kBoxCoder{10.0F, 10.0F, 5.0F, 5.0F};

// Channel c of image n of an output [N, C, 1, 1].
float output_at(const FeatureMap& map, int n, int c) { return map.pixel(n, c / kBlock, 0, 0)[c % kBlock]; }

}  // namespace

BoxHead::BoxHead(WeightReader& weights, const std::string& prefix, int channels, const BoxHeadConfig& config)
    : config_(config) {
  const Shape logits = weights.shape(prefix + "box_predictor.cls_score.weight");
  classes_ =
      logits.empty() ? 91 : static_cast<int>(logits.front());  // where missing, COCO's, for the error's sake
  const int size = config.roi_align.size;
  const auto layer = [&](const std::string& name, int outputs, int inputs, int extent,
                         Activation activation) {
    // The others are logits and deltas.
    const NumberFormat format =
        activation == Activation::relu ? weights.format(prefix + name) : weights.uncalibrated_format();
    return linear(weights.tensor(prefix + name + ".weight", {outputs, inputs * extent * extent}),
                  weights.vector(prefix + name + ".bias", outputs), inputs, extent, extent, activation,
                  format);
  };
  const Shape first = weights.shape(prefix + "box_head.fc6.weight");
  const bool plausible = !first.empty() && first.front() > 0 && first.front() <= kMostHidden;
  const int width = plausible ? static_cast<int>(first.front()) : kTorchvisionHidden;
  hidden_.push_back(layer("box_head.fc6", width, channels, size, Activation::relu));
  for (int k = 1; k < config.layers; ++k) {
    hidden_.push_back(layer(fmt::format("box_head.fc{}", 6 + k), width, width, 1, Activation::relu));
  }
  class_logits_ = layer("box_predictor.cls_score", classes_, width, 1, Activation::none);
  box_deltas_ = layer("box_predictor.bbox_pred", classes_ * 4, width, 1, Activation::none);
}

ArenaVector<ScoredBox> BoxHead::operator()(std::span<const PyramidLevel> pyramid,
                                           const ArenaVector<Box>& proposals, const ImageExtent& image,
                                           Arena& arena) const {
  ArenaVector<ScoredBox> detections(arena, static_cast<std::size_t>(std::max(config_.max_detections, 0)));
  Candidates candidates(arena, proposals.capacity() * static_cast<std::size_t>(std::max(classes_ - 1, 0)));
  // Passes without proposals run too, so that all pictures of a shape ask for the same memory.
  for (std::size_t first = 0; first < proposals.capacity(); first += kProposalsPerPass) {
    const std::size_t capacity = std::min(kProposalsPerPass, proposals.capacity() - first);
    const std::size_t begin = std::min(first, proposals.size());
    const std::size_t count = std::min(capacity, proposals.size() - begin);
    classify(pyramid, proposals.span().subspan(begin, count), static_cast<int>(capacity), image, candidates,
             arena);
  }
  const NmsOptions options{config_.nms_threshold, config_.max_detections, classes_};
  for (const int i : batched_nms(candidates, options, arena)) {
    const auto index = static_cast<std::size_t>(i);
    detections.push_back({candidates.boxes[index], candidates.scores[index], candidates.groups[index]});
  }
  return detections;
}

void BoxHead::classify(std::span<const PyramidLevel> pyramid, std::span<const Box> proposals, int capacity,
                       const ImageExtent& image, Candidates& candidates, Arena& arena) const {
  FeatureMap features = multi_scale_roi_align(pyramid, proposals, config_.roi_align, arena, 0, capacity,
                                              hidden_.front().input_numbers());
  for (std::size_t k = 0; k < hidden_.size(); ++k) {
    const Conv2d& next = k + 1 < hidden_.size() ? hidden_[k + 1] : class_logits_;
    features = hidden_[k](std::move(features), arena, 0, nullptr, next.input_numbers());
  }
  const FeatureMap logits = class_logits_(features, arena), deltas = box_deltas_(features, arena);

  ArenaVector<float> probabilities(arena, static_cast<std::size_t>(classes_));
  probabilities.resize(probabilities.capacity());
  for (int n = 0; n < static_cast<int>(proposals.size()); ++n) {
    for (int c = 0; c < classes_; ++c) probabilities[static_cast<std::size_t>(c)] = output_at(logits, n, c);
    softmax(probabilities.span());
    for (int c = 1; c < classes_; ++c) {
      const float score = probabilities[static_cast<std::size_t>(c)];
      if (!(score > config_.score_threshold)) continue;  // also drops a NaN
      const Box box = clip(decode_box(proposals[static_cast<std::size_t>(n)], output_at(deltas, n, 4 * c),
                                      output_at(deltas, n, 4 * c + 1), output_at(deltas, n, 4 * c + 2),
                                      output_at(deltas, n, 4 * c + 3), kBoxCoder),
                           static_cast<float>(image.width), static_cast<float>(image.height));
      if (!(box.width() >= config_.min_side && box.height() >= config_.min_side)) continue;
      candidates.add(box, score, c);
    }
  }
}

}  // namespace penumbra::nn
