#include "nn/models/random_weights.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "nn/base/counter_random.h"

namespace penumbra::nn {

namespace {

void add_norm(Shapes& shapes, const std::string& name, std::int64_t channels) {
  for (const char* part : {".weight", ".bias", ".running_mean", ".running_var"})
    shapes[name + part] = {channels};
}

void add_layer(Shapes& shapes, const std::string& name, const Shape& weight, std::int64_t outputs) {
  shapes[name + ".weight"] = weight;
  shapes[name + ".bias"] = {outputs};
}

Shapes mask_rcnn_shapes(bool attention) {
  Shapes shapes;
  const std::string body = "backbone.body.", fpn = "backbone.fpn.", heads = "roi_heads.";
  shapes[body + "conv1.weight"] = {64, 3, 7, 7};
  add_norm(shapes, body + "bn1", 64);
  std::int64_t inputs = 64;
  const int blocks[] = {3, 4, 6, 3};
  for (int stage = 0; stage < 4; ++stage) {
    const std::int64_t middle = 64L << stage, outputs = 4 * middle;
    for (int b = 0; b < blocks[stage]; ++b) {
      const std::string block = fmt::format("{}layer{}.{}.", body, stage + 1, b);
      shapes[block + "conv1.weight"] = {middle, inputs, 1, 1};
      shapes[block + "conv2.weight"] = {middle, middle, 3, 3};
      shapes[block + "conv3.weight"] = {outputs, middle, 1, 1};
      add_norm(shapes, block + "bn1", middle);
      add_norm(shapes, block + "bn2", middle);
      add_norm(shapes, block + "bn3", outputs);
      if (b == 0) {
        shapes[block + "downsample.0.weight"] = {outputs, inputs, 1, 1};
        add_norm(shapes, block + "downsample.1", outputs);
      }
      inputs = outputs;
    }
    add_layer(shapes, fmt::format("{}inner_blocks.{}.0", fpn, stage), {256, inputs, 1, 1}, 256);
    add_layer(shapes, fmt::format("{}layer_blocks.{}.0", fpn, stage), {256, 256, 3, 3}, 256);
    if (attention) {
      const std::string name = fmt::format("{}attention.{}.", fpn, stage);
      shapes[name + "spatial.weight"] = {1, 2, 7, 7};
      shapes[name + "channel.reduce.weight"] = {16, 256};
      shapes[name + "channel.expand.weight"] = {256, 16};
    }
    add_layer(shapes, fmt::format("{}mask_head.{}.0", heads, stage), {256, 256, 3, 3}, 256);
  }
  add_layer(shapes, "rpn.head.conv.0.0", {256, 256, 3, 3}, 256);
  add_layer(shapes, "rpn.head.cls_logits", {3, 256, 1, 1}, 3);
  add_layer(shapes, "rpn.head.bbox_pred", {12, 256, 1, 1}, 12);
  add_layer(shapes, heads + "box_head.fc6", {1024, 12544}, 1024);
  add_layer(shapes, heads + "box_head.fc7", {1024, 1024}, 1024);
  add_layer(shapes, heads + "box_predictor.cls_score", {91, 1024}, 91);
  add_layer(shapes, heads + "box_predictor.bbox_pred", {364, 1024}, 364);
  add_layer(shapes, heads + "mask_predictor.conv5_mask", {256, 256, 2, 2}, 256);
  add_layer(shapes, heads + "mask_predictor.mask_fcn_logits", {91, 256, 1, 1}, 91);
  return shapes;
}

// See GAINS in weights_tools/reference/make_mask_rcnn_fixtures.py.
double gain(const std::string& name, bool attention) {
  const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
  if (has("inner_blocks")) return attention ? 0.9 : 0.15;
  if (has("rpn.head.bbox_pred")) return 0.15;
  if (has("bbox_pred") || has("cls_score") || has("mask_fcn_logits")) return 1.0;
  for (const char* half : {"conv3", "cls_logits", "spatial", "reduce", "expand"}) {
    if (has(half)) return 0.5;
  }
  return 1.5;
}

}  // namespace

StateDict random_state(const Shapes& shapes, const std::function<double(const std::string&)>& gain) {
  StateDict state;
  state.source = "random weights";
  std::uint32_t stream = 0;
  for (const auto& [name, shape] : shapes) {
    ++stream;
    const bool norm = name.find("bn") != std::string::npos || name.find("downsample.1") != std::string::npos;
    float scale = 0.1F, offset = 0.0F;
    if (name.ends_with("running_var") || (norm && name.ends_with("weight"))) {
      scale = 0.25F;
      offset = 1.0F;
    } else if (shape.size() > 1) {
      const auto fan_in = static_cast<double>(elements(shape) / shape.front());
      scale = static_cast<float>(gain(name) * std::sqrt(3.0 / fan_in));
    }
    auto values = std::make_shared<std::vector<float>>(static_cast<std::size_t>(elements(shape)));
    for (std::size_t i = 0; i < values->size(); ++i) {
      (*values)[i] = offset + scale * counter_uniform_f32(stream, static_cast<std::uint32_t>(i));
    }
    state.tensors[name] = {DataType::f32, shape, std::as_bytes(std::span(*values))};
    state.owners.push_back(std::move(values));
  }
  return state;
}

StateDict random_mask_rcnn(bool attention, double class_gain) {
  return random_state(mask_rcnn_shapes(attention), [&](const std::string& name) {
    return gain(name, attention) * (name.ends_with("cls_score.weight") ? class_gain : 1.0);
  });
}

}  // namespace penumbra::nn
