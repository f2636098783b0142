// ONNX's operators on maps: convolutions, pools, Resize, RoiAlign, BatchNormalization.
#include <algorithm>
#include <cmath>

#include "nn/layers/batch_norm.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/conv_transpose2d.h"
#include "nn/layers/pooling.h"
#include "nn/layers/roi_align.h"
#include "nn/layers/upsample.h"
#include "tests/support/onnx_operators.h"

namespace penumbra::test {

using namespace nn;

namespace {

const Tensor& map_of(const Tensors& inputs) {
  require(inputs.front().shape.size() == 4, "not a map of two dimensions");
  return inputs.front();
}

// The one value of a list that has the same one twice.
int both(const Integers& pair, const char* reason) {
  require(pair.size() == 2 && pair[0] == pair[1], reason);
  return static_cast<int>(pair[0]);
}

// [top, left, bottom, right]; auto_pad included.
Integers pads_of(const OnnxNode& node, const Tensor& x, const Integers& kernel, const Integers& strides,
                 const Integers& dilations) {
  const std::string automatic = node.text("auto_pad", "NOTSET");
  if (automatic == "NOTSET") return node.integers("pads", {0, 0, 0, 0});
  Integers pads(4, 0);
  if (automatic == "VALID") return pads;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::int64_t in = x.extent(2 + axis), out = (in + strides[axis] - 1) / strides[axis];
    const std::int64_t total =
        std::max<std::int64_t>((out - 1) * strides[axis] + dilations[axis] * (kernel[axis] - 1) + 1 - in, 0);
    pads[axis] = automatic == "SAME_UPPER" ? total / 2 : total - total / 2;
    pads[axis + 2] = total - pads[axis];
  }
  return pads;
}

int one_padding(const Integers& pads) {
  require(pads.size() == 4 && std::all_of(pads.begin(), pads.end(), [&](auto p) { return p == pads[0]; }),
          "padding differs from side to side");
  return static_cast<int>(pads[0]);
}

// Explicit zeros around a map, for padding that differs from side to side.
Tensor pad(const Tensor& x, const Integers& pads) {
  Tensor y({x.extent(0), x.extent(1), x.extent(2) + pads[0] + pads[2], x.extent(3) + pads[1] + pads[3]});
  for (std::int64_t n = 0; n < x.extent(0); ++n) {
    for (std::int64_t c = 0; c < x.extent(1); ++c) {
      for (std::int64_t i = 0; i < x.extent(2); ++i) {
        for (std::int64_t j = 0; j < x.extent(3); ++j)
          y.at(n, c, i + pads[0], j + pads[1]) = x.at(n, c, i, j);
      }
    }
  }
  return y;
}

// A line [N, C, L] as a map of one row; true where it was one.
bool make_map(Tensor& x) {
  if (x.shape.size() != 3) return false;
  x.shape.insert(x.shape.begin() + 2, 1);
  return true;
}

// Where the map has one row and so has the kernel, the stride and dilation of rows do not matter.
Integers of_columns(const Integers& line) { return {line.at(0), line.at(0)}; }

PoolOptions pool_options(const OnnxNode& node, const Tensor& x) {
  require(node.integer("ceil_mode", 0) == 0, "extents rounded up");
  require(both(node.integers("dilations", {1, 1}), "dilations differ") == 1, "dilated windows");
  const Integers kernel = node.integers("kernel_shape", {}), strides = node.integers("strides", {1, 1});
  PoolOptions options;
  options.kernel = both(kernel, "window is no square");
  options.stride = both(strides, "strides differ");
  options.padding = one_padding(pads_of(node, x, kernel, strides, {1, 1}));
  require(options.padding <= options.kernel / 2, "padding of more than half the window");
  return options;
}

}  // namespace

Tensors conv(const OnnxNode& node, int, const Tensors& inputs) {
  Tensor x = inputs[0], weight = inputs[1];
  const bool line = make_map(x) && make_map(weight);
  require(x.shape.size() == 4, "more than two dimensions");
  Integers strides = node.integers("strides", {1, 1}), dilations = node.integers("dilations", {1, 1});
  if (line) strides = of_columns(strides), dilations = of_columns(dilations);
  Conv2dOptions options;
  options.stride = both(strides, "strides differ");
  options.dilation = both(dilations, "dilations differ");
  options.groups = static_cast<int>(node.integer("group", 1));
  Integers pads = pads_of(node, x, {weight.extent(2), weight.extent(3)}, strides, dilations);
  if (pads.size() == 2) pads = {0, pads[0], 0, pads[1]};
  const bool uniform = std::all_of(pads.begin(), pads.end(), [&](auto p) { return p == pads[0]; });
  if (uniform) options.padding = static_cast<int>(pads[0]);
  const std::vector<float> bias = inputs.size() > 2 ? inputs[2].values : std::vector<float>{};
  Arena arena;
  Tensor y =
      to_tensor(Conv2d(weight, bias, options)(to_feature_map(uniform ? x : pad(x, pads), arena), arena));
  if (line) y.shape.erase(y.shape.begin() + 2);
  return {y};
}

Tensors conv_transpose(const OnnxNode& node, int, const Tensors& inputs) {
  Tensor x = inputs[0], weight = inputs[1];
  const bool line = make_map(x) && make_map(weight);
  require(x.shape.size() == 4, "more than two dimensions");
  require(node.integer("group", 1) == 1, "groups of a transposed convolution");
  require(node.text("auto_pad", "NOTSET") == "NOTSET" && node.attributes.count("output_shape") == 0,
          "padding derived from the output's shape");
  ConvTranspose2dOptions options;
  const Integers strides = node.integers("strides", {1, 1}), dilations = node.integers("dilations", {1, 1});
  options.stride = both(line ? of_columns(strides) : strides, "strides differ");
  options.dilation = both(line ? of_columns(dilations) : dilations, "dilations differ");
  if (line) {
    for (const char* name : {"pads", "output_padding"})
      require(node.attributes.count(name) == 0, "a padded line");
  }
  options.padding = one_padding(node.integers("pads", {0, 0, 0, 0}));
  options.output_padding = both(node.integers("output_padding", {0, 0}), "output paddings differ");
  const std::vector<float> bias = inputs.size() > 2 ? inputs[2].values : std::vector<float>{};
  Arena arena;
  Tensor y = to_tensor(ConvTranspose2d(weight, bias, options)(to_feature_map(x, arena), arena));
  if (line) y.shape.erase(y.shape.begin() + 2);
  return {y};
}

Tensors max_pool_node(const OnnxNode& node, int, const Tensors& inputs) {
  const Tensor& x = map_of(inputs);
  require(node.outputs.size() == 1, "asks for the indices of the maxima");
  Arena arena;
  return {to_tensor(max_pool(to_feature_map(x, arena), pool_options(node, x), arena))};
}

Tensors average_pool(const OnnxNode& node, int, const Tensors& inputs) {
  const Tensor& x = map_of(inputs);
  Arena arena;
  return {to_tensor(avg_pool(to_feature_map(x, arena), pool_options(node, x),
                             node.integer("count_include_pad", 0) != 0, arena))};
}

Tensors global_average_pool(const OnnxNode&, int, const Tensors& inputs) {
  Arena arena;
  return {to_tensor(global_avg_pool(to_feature_map(map_of(inputs), arena), arena))};
}

Tensors global_max_pool_node(const OnnxNode&, int, const Tensors& inputs) {
  Arena arena;
  return {to_tensor(global_max_pool(to_feature_map(map_of(inputs), arena), arena))};
}

// Resize of opset 11 and up (X, roi, scales, sizes), of opset 10 and Upsample (X, scales).
Tensors resize(const OnnxNode& node, int opset, const Tensors& inputs) {
  const Tensor& x = map_of(inputs);
  const bool old = inputs.size() == 2;
  const Tensor& scales = inputs[old ? 1 : 2];
  std::int64_t extents[2];
  for (std::size_t axis = 0; axis < 4; ++axis) {
    const auto in = static_cast<float>(x.extent(axis));
    const float out = !scales.values.empty() ? in * scales.values[axis] : inputs[3].values[axis];
    require(out == std::floor(out), "the scale is not the ratio of the extents");
    require(axis > 1 || out == in, "resizes images or channels");
    if (axis > 1) extents[axis - 2] = static_cast<std::int64_t>(out);
  }
  const int height = static_cast<int>(extents[0]), width = static_cast<int>(extents[1]);
  const std::string mode = node.text("mode", "nearest");
  const std::string coordinates =
      node.text("coordinate_transformation_mode", opset < 11 ? "asymmetric" : "half_pixel");
  const std::string rounding = node.text("nearest_mode", opset < 11 ? "floor" : "round_prefer_floor");
  Arena arena;
  const FeatureMap map = to_feature_map(x, arena);
  if (mode == "nearest") {
    // Whole factors upwards: rounding the pixel's centre is flooring its corner.
    const bool whole = height % x.extent(2) == 0 && width % x.extent(3) == 0;
    require((coordinates == "asymmetric" && rounding == "floor") ||
                (coordinates == "half_pixel" && rounding == "round_prefer_floor" && whole),
            "another rule for the nearest pixel");
    return {to_tensor(upsample_nearest(map, height, width, arena))};
  }
  require(mode == "linear", "neither nearest nor linear");
  require(coordinates != "pytorch_half_pixel" || (height > 1 && width > 1),
          "pytorch_half_pixel to one pixel, which PyTorch itself does otherwise");
  require(
      coordinates == "half_pixel" || coordinates == "pytorch_half_pixel" || coordinates == "align_corners",
      "another rule for coordinates");
  return {to_tensor(upsample_bilinear(map, height, width, coordinates == "align_corners", arena))};
}

Tensors roi_align_node(const OnnxNode& node, int opset, const Tensors& inputs) {
  const Tensor& x = map_of(inputs);
  require(node.text("mode", "avg") == "avg", "maximum of the samples");
  require(node.integer("output_height", 1) == node.integer("output_width", 1), "output is no square");
  require(std::all_of(inputs[2].values.begin(), inputs[2].values.end(), [](float b) { return b == 0.0F; }),
          "regions of several images");
  RoiAlignOptions options;
  options.size = static_cast<int>(node.integer("output_height", 1));
  options.sampling = static_cast<int>(node.integer("sampling_ratio", 0));
  options.aligned = opset >= 16 && node.text("coordinate_transformation_mode", "half_pixel") == "half_pixel";
  std::vector<Box> boxes;
  for (std::size_t i = 0; i + 3 < inputs[1].values.size(); i += 4) {
    const float* b = inputs[1].values.data() + i;
    boxes.push_back({b[0], b[1], b[2], b[3]});
  }
  Arena arena;
  return {to_tensor(
      roi_align(to_feature_map(x, arena), node.number("spatial_scale", 1.0F), boxes, options, arena))};
}

Tensors batch_normalization(const OnnxNode& node, int, const Tensors& inputs) {
  const Tensor& x = map_of(inputs);
  require(node.integer("training_mode", 0) == 0 && node.outputs.size() == 1, "training");
  const std::int64_t channels = x.extent(1);
  Tensor identity({channels, channels, 1, 1});
  for (std::int64_t c = 0; c < channels; ++c) identity.at(c, c, 0, 0) = 1.0F;
  const FoldedConvolution folded =
      fold_batch_norm(identity, {inputs[1].values, inputs[2].values, inputs[3].values, inputs[4].values,
                                 node.number("epsilon", 1e-5F)});
  Arena arena;
  return {to_tensor(Conv2d(folded.weight, folded.bias, {})(to_feature_map(x, arena), arena))};
}

}  // namespace penumbra::test
