#include "nn/models/yolov5_features.h"

#include <fmt/format.h>

#include <utility>

#include "nn/layers/concat.h"
#include "nn/layers/upsample.h"

namespace penumbra::nn {

namespace {

FeatureMap join(const FeatureMap& a, const FeatureMap& b, Arena& arena) {
  const std::array<const FeatureMap*, 2> parts{&a, &b};
  return concat(parts, arena);
}

FeatureMap join_upsampled(const FeatureMap& coarse, const FeatureMap& fine, Arena& arena) {
  return join(upsample_nearest(coarse, 2, arena), fine, arena);
}

}  // namespace

Yolov5Features::Yolov5Features(WeightReader& weights, const Yolov5Shape& shape) {
  const auto& c = shape.channels;
  const auto conv = [&](int layer, Yolov5ConvShape convolution) {
    return yolov5_conv(weights, fmt::format("model.{}", layer), convolution);
  };
  stem_ = yolov5_conv(weights, "model.0", {3, c[0], 6, 2}, kImageBlock);
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    const int layer = 1 + 2 * static_cast<int>(k);
    stages_[k].down = conv(layer, {c[k], c[k + 1], 3, 2});
    stages_[k].c3 = Yolov5C3(
        weights, fmt::format("model.{}", layer + 1), c[k + 1], c[k + 1], shape.backbone_repetitions[k],
        shape.attention ? Yolov5Residual::shortcut_and_attention : Yolov5Residual::shortcut);
  }
  sppf_ = Yolov5Sppf(weights, "model.9", c[4]);
  const auto c3 = [&](int layer, int inputs, int outputs) {
    return Yolov5C3(weights, fmt::format("model.{}", layer), inputs, outputs, shape.neck_repetitions,
                    Yolov5Residual::none);
  };
  lateral5_ = conv(10, {c[4], c[3]});
  top_down4_ = c3(13, 2 * c[3], c[3]);
  lateral4_ = conv(14, {c[3], c[2]});
  top_down3_ = c3(17, 2 * c[2], c[2]);
  bottom_up_[0] = {conv(18, {c[2], c[2], 3, 2}), c3(20, 2 * c[2], c[3])};
  bottom_up_[1] = {conv(21, {c[3], c[3], 3, 2}), c3(23, 2 * c[3], c[4])};
}

std::array<FeatureMap, 3> Yolov5Features::operator()(FeatureMap image, Arena& arena) const {
  // Maps that a 3 x 3 convolution reads get a border of 1.
  const auto stage = [&](std::size_t k, const FeatureMap& x, int border) {
    return stages_[k].c3(stages_[k].down(x, arena), arena, border);
  };
  FeatureMap p = stem_(image, arena, 1);
  image = FeatureMap();  // here and below: gives its memory back
  p = stage(0, p, 1);
  FeatureMap p3 = stage(1, p, 1);
  p = FeatureMap();
  const FeatureMap p4 = stage(2, p3, 1);
  const FeatureMap t5 = lateral5_(sppf_(stage(3, p4, 0), arena), arena);
  const FeatureMap t4 = lateral4_(top_down4_(join_upsampled(t5, p4, arena), arena), arena);
  std::array<FeatureMap, 3> maps;
  maps[0] = top_down3_(join_upsampled(t4, p3, arena), arena, 1);
  p3 = FeatureMap();
  maps[1] = bottom_up_[0].c3(join(bottom_up_[0].down(maps[0], arena), t4, arena), arena, 1);
  maps[2] = bottom_up_[1].c3(join(bottom_up_[1].down(maps[1], arena), t5, arena), arena);
  return maps;
}

}  // namespace penumbra::nn
