#include "nn/models/yolov5_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "nn/layers/concat.h"
#include "nn/layers/elementwise.h"
#include "nn/layers/pooling.h"

namespace penumbra::nn {

namespace {

constexpr float kBatchNormEps = 1e-3F;  // where the weights do not say
constexpr PoolOptions kSppfPool{5, 1, 2};
constexpr float kSlope = 0.1F;                         // of leaky_relu
constexpr int kSqueezeRatio = 32, kLeastSqueezed = 8;  // channels of coordinate attention

// Weight and bias of a Conv, its batch norm folded in.
FoldedConvolution folded_conv(WeightReader& weights, const std::string& name, const Yolov5ConvShape& shape) {
  const Shape weight{shape.outputs, shape.inputs, shape.kernel, shape.kernel};
  if (weights.has(name + ".conv.bias")) {
    return {weights.tensor(name + ".conv.weight", weight),
            weights.vector(name + ".conv.bias", shape.outputs)};
  }
  return weights.folded(name + ".conv", weight, name + ".bn", weights.batch_norm_eps(kBatchNormEps));
}

CoordinateAttention coordinate_attention(WeightReader& weights, const std::string& name, int channels) {
  const int squeezed = std::max(channels / kSqueezeRatio, kLeastSqueezed);
  FoldedConvolution squeeze = folded_conv(weights, name + ".squeeze", {channels, squeezed});
  CoordinateAttentionWeights tensors;
  tensors.squeeze = std::move(squeeze.weight);
  tensors.squeeze_bias = std::move(squeeze.bias);
  const Shape expand{channels, squeezed, 1, 1};
  tensors.expand_rows = weights.tensor(name + ".expand_rows.weight", expand);
  tensors.expand_rows_bias = weights.vector(name + ".expand_rows.bias", channels);
  tensors.expand_columns = weights.tensor(name + ".expand_columns.weight", expand);
  tensors.expand_columns_bias = weights.vector(name + ".expand_columns.bias", channels);
  return CoordinateAttention(tensors);
}

}  // namespace

Conv2d yolov5_conv(WeightReader& weights, const std::string& name, const Yolov5ConvShape& shape,
                   int input_block) {
  Conv2dOptions options;
  options.stride = shape.stride;
  options.padding = (shape.kernel - 1) / 2;  // the 6 x 6 stem's, too
  options.activation = shape.activation;
  options.slope = kSlope;
  options.format = input_block == kBlock ? weights.format(name) : weights.uncalibrated_format();
  const FoldedConvolution folded = folded_conv(weights, name, shape);
  return {folded.weight, folded.bias, options, input_block};
}

Yolov5C3::Yolov5C3(WeightReader& weights, const std::string& name, int inputs, int outputs, int repetitions,
                   Yolov5Residual kind)
    : shortcut_(kind != Yolov5Residual::none) {
  const int hidden = outputs / 2;
  cv1_ = yolov5_conv(weights, name + ".cv1", {inputs, hidden});
  cv2_ = yolov5_conv(weights, name + ".cv2", {inputs, hidden});
  cv3_ = yolov5_conv(weights, name + ".cv3", {2 * hidden, outputs});
  const bool attention = kind == Yolov5Residual::shortcut_and_attention;
  const Activation activation = attention ? Activation::leaky_relu : Activation::silu;
  for (int i = 0; i < repetitions; ++i) {
    const std::string block = fmt::format("{}.m.{}.", name, i);
    Residual residual;
    residual.cv1 = yolov5_conv(weights, block + "cv1", {hidden, hidden, 1, 1, activation});
    residual.cv2 = yolov5_conv(weights, block + "cv2", {hidden, hidden, 3, 1, activation});
    if (attention) residual.attention = coordinate_attention(weights, block + "attention", hidden);
    residuals_.push_back(std::move(residual));
  }
}

FeatureMap Yolov5C3::operator()(const FeatureMap& x, Arena& arena, int output_border) const {
  FeatureMap deep = cv1_(x, arena);
  for (const Residual& residual : residuals_) {
    FeatureMap y = residual.cv2(residual.cv1(deep, arena, 1, nullptr, residual.cv2.input_numbers()), arena);
    if (residual.attention) {
      residual.attention->apply(y, arena, &deep);
    } else if (shortcut_) {
      add(y, deep);
    }
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
