#include "nn/models/yolov5_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace penumbra::nn {

namespace {

constexpr int kStemChannels = 64, kPrototypeChannels = 256;  // at width 1
constexpr int kThirdStage = 9;                               // its C3's repetitions at depth 1
constexpr int kWidestStem = 1024;  // wider ones are damaged files, whose network would not fit into memory
constexpr int kMostClasses = 10000;

struct Model {
  char letter;
  double width, depth;
};
constexpr std::array<Model, 5> kModels{{{'n', 0.25, 1.0 / 3.0},
                                        {'s', 0.5, 1.0 / 3.0},
                                        {'m', 0.75, 2.0 / 3.0},
                                        {'l', 1.0, 1.0},
                                        {'x', 1.25, 4.0 / 3.0}}};

}  // namespace

std::string Yolov5Shape::name() const {
  const char* family = attention && fusion ? "AFNET-" : "YOLOv5";
  const char* suffix = masks ? "-seg" : "";
  const char* part = attention == fusion ? "" : attention ? " with coordinate attention" : " with ASFF";
  for (const Model& model : kModels) {
    if (model.width == width && model.depth == depth) {
      return fmt::format("{}{}{}{}", family, model.letter, suffix, part);
    }
  }
  if (attention && fusion) family = "AFNET";
  return fmt::format("{}{}{} (width {:.3g}, depth {:.3g})", family, suffix, part, width, depth);
}

Yolov5Shape yolov5_shape(double width, double depth, int classes, bool masks) {
  Yolov5Shape shape;
  const auto channels = [&](int full) { return static_cast<int>(std::ceil(full * width / 8.0)) * 8; };
  const auto repetitions = [&](int full) {
    return std::max(static_cast<int>(std::nearbyint(full * depth)), 1);
  };
  for (std::size_t k = 0; k < shape.channels.size(); ++k) shape.channels[k] = channels(kStemChannels << k);
  shape.backbone_repetitions = {repetitions(3), repetitions(6), repetitions(kThirdStage), repetitions(3)};
  shape.neck_repetitions = repetitions(3);
  shape.prototype_channels = channels(kPrototypeChannels);
  shape.classes = classes;
  shape.masks = masks;
  shape.width = width;
  shape.depth = depth;
  return shape;
}

Yolov5Shape yolov5_shape(const WeightReader& weights) {
  double width = 0.25;
  const Shape stem = weights.shape("model.0.conv.weight");
  if (stem.size() == 4 && stem.front() > 0 && stem.front() <= kWidestStem) {
    width = static_cast<double>(stem.front()) / kStemChannels;
  }
  int blocks = 0;
  while (weights.has(fmt::format("model.6.m.{}.cv1.conv.weight", blocks))) ++blocks;
  const double depth = std::max(blocks, 1) / static_cast<double>(kThirdStage);

  const bool masks = weights.has("model.24.proto.cv1.conv.weight");
  int classes = 80;
  const Shape head = weights.shape("model.24.m.0.weight");
  if (!head.empty() && head.front() <= kMostClasses) {
    const auto outputs = static_cast<int>(head.front()) / kAnchorsPerCell;
    classes = std::max(outputs - kBoxValues - (masks ? kPrototypes : 0), 1);
  }
  Yolov5Shape shape = yolov5_shape(width, depth, classes, masks);
  shape.attention = weights.has("model.2.m.0.attention.squeeze.conv.weight");
  shape.fusion = weights.has("asff.0.weight.0.weight");
  return shape;
}

}  // namespace penumbra::nn
