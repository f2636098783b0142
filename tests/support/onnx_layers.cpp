#include "tests/support/onnx_layers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "nn/layers/activations.h"
#include "nn/layers/concat.h"
#include "nn/layers/elementwise.h"
#include "nn/layers/nms.h"
#include "tests/support/onnx_operators.h"

namespace penumbra::test {

namespace {

using namespace nn;

Tensors non_max_suppression(const OnnxNode& node, int, const Tensors& inputs) {
  const Tensor &boxes = inputs[0], &scores = inputs[1];
  const auto scalar = [&](std::size_t i, float otherwise) {
    return inputs.size() > i && !inputs[i].values.empty() ? inputs[i].values[0] : otherwise;
  };
  const int most = static_cast<int>(scalar(2, 0.0F));
  const float overlap = scalar(3, 0.0F), least = scalar(4, -INFINITY);
  const auto count = static_cast<std::size_t>(boxes.extent(1));
  Tensor kept({0, 3});
  for (std::int64_t image = 0; image < scores.extent(0); ++image) {
    for (std::int64_t category = 0; category < scores.extent(1); ++category) {
      std::vector<Box> candidates;
      std::vector<float> candidate_scores;
      std::vector<std::size_t> indices;
      for (std::size_t i = 0; i < count; ++i) {
        const auto first = static_cast<std::size_t>(image * scores.extent(1) + category) * count;
        if (scores.values[first + i] <= least) continue;
        const float* b = boxes.values.data() + (static_cast<std::size_t>(image) * count + i) * 4;
        if (node.integer("center_point_box", 0) == 1) {
          candidates.push_back({b[0] - b[2] / 2, b[1] - b[3] / 2, b[0] + b[2] / 2, b[1] + b[3] / 2});
        } else {  // two opposite corners (y, x) in any order
          candidates.push_back(
              {std::min(b[1], b[3]), std::min(b[0], b[2]), std::max(b[1], b[3]), std::max(b[0], b[2])});
        }
        candidate_scores.push_back(scores.values[first + i]);
        indices.push_back(i);
      }
      const std::vector<int> groups(candidates.size(), 0);
      for (const int i : batched_nms(candidates, candidate_scores, groups, overlap, most)) {
        kept.values.insert(kept.values.end(), {static_cast<float>(image), static_cast<float>(category),
                                               static_cast<float>(indices[static_cast<std::size_t>(i)])});
        kept.shape[0] += 1;
      }
    }
  }
  return {kept};
}

// Any tensor with `axis` as the channels: [before, axis, behind, 1].
Tensor with_channels(const Tensor& x, std::int64_t axis) {
  if (axis < 0) axis += static_cast<std::int64_t>(x.shape.size());
  const auto split = x.shape.begin() + axis;
  return {{elements({x.shape.begin(), split}), *split, elements({split + 1, x.shape.end()}), 1}, x.values};
}

Tensors softmax_node(const OnnxNode& node, int opset, const Tensors& inputs) {
  const Tensor& x = inputs[0];
  std::int64_t axis = node.integer("axis", opset < 13 ? 1 : -1);
  if (axis < 0) axis += static_cast<std::int64_t>(x.shape.size());
  Tensor channels = with_channels(x, axis);
  if (opset < 13) channels.shape = {channels.extent(0), channels.extent(1) * channels.extent(2), 1, 1};
  Arena arena;
  FeatureMap map = to_feature_map(channels, arena);
  softmax_channels(map);
  return {{x.shape, to_tensor(map).values}};
}

Tensors concat_node(const OnnxNode& node, int, const Tensors& inputs) {
  const std::int64_t axis = node.integer("axis", 1);
  Arena arena;
  std::vector<FeatureMap> maps;
  std::vector<const FeatureMap*> pointers;
  Shape shape = inputs[0].shape;
  const std::size_t joined =
      static_cast<std::size_t>(axis < 0 ? axis + static_cast<std::int64_t>(shape.size()) : axis);
  shape[joined] = 0;
  for (const Tensor& input : inputs) {
    maps.push_back(to_feature_map(with_channels(input, axis), arena));
    shape[joined] += input.shape[joined];
  }
  for (const FeatureMap& map : maps) pointers.push_back(&map);
  return {{shape, to_tensor(concat(pointers, arena)).values}};
}

Tensors split_node(const OnnxNode& node, int, const Tensors& inputs) {
  const Tensor& x = inputs[0];
  std::int64_t axis = node.integer("axis", 0);
  if (axis < 0) axis += static_cast<std::int64_t>(x.shape.size());
  const auto parts = static_cast<std::int64_t>(node.outputs.size());
  Integers sizes = node.integers("split", {});
  if (inputs.size() > 1) sizes.assign(inputs[1].values.begin(), inputs[1].values.end());
  if (sizes.empty())
    sizes.assign(static_cast<std::size_t>(parts), x.shape[static_cast<std::size_t>(axis)] / parts);
  require(std::all_of(sizes.begin(), sizes.end(), [](auto size) { return size > 0; }),
          "parts without a channel");
  Arena arena;
  const std::vector<int> channels(sizes.begin(), sizes.end());
  Tensors outputs;
  for (const FeatureMap& part : split(to_feature_map(with_channels(x, axis), arena), channels, arena)) {
    Shape shape = x.shape;
    shape[static_cast<std::size_t>(axis)] = part.channels();
    outputs.emplace_back(shape, to_tensor(part).values);
  }
  return outputs;
}

// Sums and products: the smaller tensor is the one that is broadcast.
template <class Operation>
Tensors broadcast(const Tensors& inputs, Operation operation) {
  const bool swap = inputs[1].values.size() > inputs[0].values.size();
  const Tensor &y = inputs[swap ? 1 : 0], &x = inputs[swap ? 0 : 1];
  const auto rank4 = [](const Tensor& t) {
    require(t.shape.size() <= 4, "more than four dimensions");
    Shape shape(4 - t.shape.size(), 1);
    shape.insert(shape.end(), t.shape.begin(), t.shape.end());
    return Tensor(shape, t.values);
  };
  const Tensor whole = rank4(y), part = rank4(x);
  for (std::size_t axis = 0; axis < 4; ++axis) {
    require(part.extent(axis) == 1 || part.extent(axis) == whole.extent(axis), "both tensors are broadcast");
  }
  Arena arena;
  FeatureMap map = to_feature_map(whole, arena);
  operation(map, to_feature_map(part, arena));
  return {{y.shape, to_tensor(map).values}};
}

Tensors add_node(const OnnxNode&, int, const Tensors& inputs) { return broadcast(inputs, add); }
Tensors multiply_node(const OnnxNode&, int, const Tensors& inputs) { return broadcast(inputs, multiply); }

Tensors activation(const OnnxNode& node, int, const Tensors& inputs) {
  static const std::map<std::string, Activation> kinds{{"Relu", Activation::relu},
                                                       {"LeakyRelu", Activation::leaky_relu},
                                                       {"Sigmoid", Activation::sigmoid},
                                                       {"HardSigmoid", Activation::hard_sigmoid},
                                                       {"HardSwish", Activation::hard_swish}};
  const Tensor& x = inputs[0];
  if (node.operation == "HardSigmoid") {
    require(std::abs(node.number("alpha", 0.2F) - 1.0F / 6.0F) < 1e-6F && node.number("beta", 0.5F) == 0.5F,
            "the slope is not 1/6");
  }
  Arena arena;
  FeatureMap map = to_feature_map({{1, 1, 1, elements(x.shape)}, x.values}, arena);
  activate(map, kinds.at(node.operation), node.number("alpha", 0.01F));
  return {{x.shape, to_tensor(map).values}};
}

using Operator = std::function<Tensors(const OnnxNode&, int, const Tensors&)>;

const std::map<std::string, Operator>& operators() {
  static const std::map<std::string, Operator> all{
      {"Add", add_node},
      {"AveragePool", average_pool},
      {"BatchNormalization", batch_normalization},
      {"Concat", concat_node},
      {"Conv", conv},
      {"ConvTranspose", conv_transpose},
      {"GlobalAveragePool", global_average_pool},
      {"GlobalMaxPool", global_max_pool_node},
      {"HardSigmoid", activation},
      {"HardSwish", activation},
      {"LeakyRelu", activation},
      {"MaxPool", max_pool_node},
      {"Mul", multiply_node},
      {"NonMaxSuppression", non_max_suppression},
      {"Relu", activation},
      {"Resize", resize},
      {"RoiAlign", roi_align_node},
      {"Sigmoid", activation},
      {"Softmax", softmax_node},
      {"Split", split_node},
      {"Upsample", resize},
  };
  return all;
}

}  // namespace

bool is_covered(const std::string& operation) { return operators().count(operation) == 1; }

std::vector<nn::Tensor> run_onnx_node(const OnnxNode& node, int opset,
                                      const std::vector<nn::Tensor>& inputs) {
  return operators().at(node.operation)(node, opset, inputs);
}

}  // namespace penumbra::test
