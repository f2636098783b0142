#include "nn/models/classifier.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "nn/layers/pooling.h"

namespace penumbra::nn {

namespace {

constexpr int kImageNetClasses = 1000;

}  // namespace

Classifier::Classifier(const StateDict& state_dict, ClassifierConfig config) : config_(config) {
  WeightReader weights(state_dict);
  config_.batch_norm_eps = weights.batch_norm_eps(config_.batch_norm_eps);
  weights.expect_metadata("activations", "ReLU");
  backbone_ = ResNet(weights, "", resnet_shape(weights, ""), config_.batch_norm_eps);
  const Shape shape = weights.shape("fc.weight");
  const std::int64_t classes = shape.empty() ? kImageNetClasses : shape.front();
  const int features = backbone_.channels().back();
  head_ = linear(weights.tensor("fc.weight", {classes, features}), weights.vector("fc.bias", classes),
                 features, 1, 1, Activation::none);
  weights.finish(name());
}

std::string Classifier::name() const { return fmt::format("ResNet-{}", backbone_.shape().depth); }

void Classifier::operator()(const ByteView& image, Arena& arena, std::vector<float>& logits) const {
  // The image's own extents decide how much memory its resizing takes.
  const Arena::Pass pass(arena, this, image.height, image.width);
  FeatureMap input = transform_image(image, config_.transform, arena, ResNet::kImageBorder);
  const std::array<FeatureMap, 4> stages = backbone_(std::move(input), arena);
  const FeatureMap outputs = head_(global_avg_pool(stages.back(), arena), arena);
  logits.resize(static_cast<std::size_t>(outputs.channels()));
  for (int c = 0; c < outputs.channels(); ++c) {
    logits[static_cast<std::size_t>(c)] = outputs.pixel(0, c / kBlock, 0, 0)[c % kBlock];
  }
}

std::vector<int> best_classes(const std::vector<float>& logits, int count) {
  std::vector<int> order(logits.size());
  std::iota(order.begin(), order.end(), 0);
  // NaN, which no order holds, goes last.
  const auto key = [&](int c) {
    const float logit = logits[static_cast<std::size_t>(c)];
    return logit == logit ? logit : -std::numeric_limits<float>::infinity();
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) > key(b); });
  order.resize(std::min(order.size(), static_cast<std::size_t>(std::max(count, 0))));
  return order;
}

}  // namespace penumbra::nn
