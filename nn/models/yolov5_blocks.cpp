#include "nn/models/yolov5_blocks.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "nn/layers/concat.h"
#include "nn/layers/elementwise.h"
#include "nn/layers/pooling.h"

namespace penumbra::nn {

namespace {

constexpr float kBatchNormEps = 1e-3F;  // where the weights do not say
constexpr PoolOptions kSppfPool{5, 1, 2};

}  // namespace

Conv2d yolov5_conv(WeightReader& weights, const std::string& name, const Yolov5ConvShape& shape,
                   int input_block) {
  Conv2dOptions options;
  options.stride = shape.stride;
  options.padding = (shape.kernel - 1) / 2;  // the 6 x 6 stem's, too
  options.activation = Activation::silu;
  if (input_block == kBlock) options.format = weights.format(name);  // the stem stays f32
  const Shape weight{shape.outputs, shape.inputs, shape.kernel, shape.kernel};
  if (weights.has(name + ".conv.bias")) {
    return {weights.tensor(name + ".conv.weight", weight), weights.vector(name + ".conv.bias", shape.outputs),
            options, input_block};
  }
  const FoldedConvolution folded =
      weights.folded(name + ".conv", weight, name + ".bn", weights.batch_norm_eps(kBatchNormEps));
  return {folded.weight, folded.bias, options, input_block};
}

Yolov5C3::Yolov5C3(WeightReader& weights, const std::string& name, int inputs, int outputs, int repetitions,
                   bool shortcut)
    : shortcut_(shortcut) {
  const int hidden = outputs / 2;
  cv1_ = yolov5_conv(weights, name + ".cv1", {inputs, hidden});
  cv2_ = yolov5_conv(weights, name + ".cv2", {inputs, hidden});
  cv3_ = yolov5_conv(weights, name + ".cv3", {2 * hidden, outputs});
  for (int i = 0; i < repetitions; ++i) {
    const std::string block = fmt::format("{}.m.{}.", name, i);
    residuals_.push_back({yolov5_conv(weights, block + "cv1", {hidden, hidden}),
                          yolov5_conv(weights, block + "cv2", {hidden, hidden, 3})});
  }
}

FeatureMap Yolov5C3::operator()(const FeatureMap& x, Arena& arena, int output_border) const {
  FeatureMap deep = cv1_(x, arena);
  for (const Residual& residual : residuals_) {
    FeatureMap y = residual.cv2(residual.cv1(deep, arena, 1), arena);
    if (shortcut_) add(y, deep);
    deep = std::move(y);
  }
  const FeatureMap flat = cv2_(x, arena);
  const std::array<const FeatureMap*, 2> parts{&deep, &flat};
  return cv3_(concat(parts, arena), arena, output_border);
}

Yolov5Sppf::Yolov5Sppf(WeightReader& weights, const std::string& name, int channels) {
  cv1_ = yolov5_conv(weights, name + ".cv1", {channels, channels / 2});
  cv2_ = yolov5_conv(weights, name + ".cv2", {channels / 2 * 4, channels});
}

FeatureMap Yolov5Sppf::operator()(const FeatureMap& x, Arena& arena) const {
  const FeatureMap z = cv1_(x, arena);
  const FeatureMap once = max_pool(z, kSppfPool, arena);
  const FeatureMap twice = max_pool(once, kSppfPool, arena);
  const FeatureMap thrice = max_pool(twice, kSppfPool, arena);
  const std::array<const FeatureMap*, 4> parts{&z, &once, &twice, &thrice};
  return cv2_(concat(parts, arena), arena);
}

}  // namespace penumbra::nn
