// Every layer, fast and naive, against the outputs of PyTorch and torchvision in tests/fixtures/layers.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "nn/layers/asff.h"
#include "nn/layers/concat.h"
#include "nn/layers/elementwise.h"
#include "nn/layers/mixed_attention.h"
#include "nn/layers/reference/reference.h"
#include "nn/layers/upsample.h"
#include "tests/nn/layers/pytorch_cases.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::LayerCase;

Conv2dOptions conv2d_options(const LayerCase& c) {
  Conv2dOptions options;
  options.stride = c.option("stride", 1);
  options.padding = c.option("padding", 0);
  options.dilation = c.option("dilation", 1);
  options.groups = c.option("groups", 1);
  options.activation = c.activation();
  options.slope = c.slope();
  return options;
}

Outputs conv2d_case(const LayerCase& c, Arena& arena) {
  const Conv2dOptions options = conv2d_options(c);
  const Tensor x = c.input("x"), weight = c.input("weight");
  const std::vector<float> bias = c.values("bias");
  const Tensor residual = c.has("residual") ? c.input("residual") : Tensor({1, 1, 1, 1});
  const FeatureMap residual_map = to_feature_map(residual, arena);
  return {to_tensor(Conv2d(weight, bias, options)(to_feature_map(x, arena), arena, 0,
                                                  c.has("residual") ? &residual_map : nullptr)),
          reference::conv2d(x, weight, bias, options, c.has("residual") ? &residual : nullptr)};
}

Outputs conv_transpose2d_case(const LayerCase& c, Arena& arena) {
  ConvTranspose2dOptions options;
  options.stride = c.option("stride", 1);
  options.padding = c.option("padding", 0);
  options.output_padding = c.option("output_padding", 0);
  options.dilation = c.option("dilation", 1);
  options.activation = c.activation();
  const Tensor x = c.input("x"), weight = c.input("weight");
  return {to_tensor(ConvTranspose2d(weight, c.values("bias"), options)(to_feature_map(x, arena), arena)),
          reference::conv_transpose2d(x, weight, c.values("bias"), options)};
}

Outputs linear_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x"), weight = c.input("weight");
  const Conv2d layer = linear(weight, c.values("bias"), static_cast<int>(x.extent(1)),
                              static_cast<int>(x.extent(2)), static_cast<int>(x.extent(3)), c.activation());
  Tensor naive = reference::linear({{x.extent(0), weight.extent(1)}, x.values}, weight, c.values("bias"),
                                   c.activation());
  naive.shape = {x.extent(0), weight.extent(0), 1, 1};
  return {to_tensor(layer(to_feature_map(x, arena), arena)), naive};
}

BatchNorm batch_norm_of(const LayerCase& c) {
  BatchNorm norm{c.values("gamma"), c.values("beta"), c.values("mean"), c.values("variance"),
                 c.option("eps", 1e-5F)};
  for (float& variance : norm.variance) variance = std::abs(variance) + 0.1F;
  return norm;
}

Outputs batch_norm_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x"), weight = c.input("weight");
  const FoldedConvolution folded = fold_batch_norm(weight, batch_norm_of(c));
  return {to_tensor(Conv2d(folded.weight, folded.bias, {})(to_feature_map(x, arena), arena)),
          reference::batch_norm(reference::conv2d(x, weight, {}, {}), batch_norm_of(c))};
}

Tensor scaled(Tensor x, float factor) {
  for (float& value : x.values) value *= factor;
  return x;
}

// For layers that change a map in place.
Outputs in_place(const Tensor& x, Arena& arena, const std::function<void(FeatureMap&)>& apply, Tensor naive) {
  FeatureMap map = to_feature_map(x, arena);
  apply(map);
  return {to_tensor(map), std::move(naive)};
}

// For layers of one map.
using Unary = std::function<FeatureMap(const LayerCase&, const FeatureMap&, Arena&)>;
using NaiveUnary = std::function<Tensor(const LayerCase&, const Tensor&)>;
Layer unary(const Unary& fast, const NaiveUnary& naive) {
  return [=](const LayerCase& c, Arena& arena) {
    const Tensor x = c.input("x");
    return Outputs{to_tensor(fast(c, to_feature_map(x, arena), arena)), naive(c, x)};
  };
}

Outputs concat_case(const LayerCase& c, Arena& arena) {
  const std::vector<Tensor> parts{c.input("a"), c.input("b"), c.input("c")};
  std::vector<FeatureMap> maps;
  for (const Tensor& part : parts) maps.push_back(to_feature_map(part, arena));
  const FeatureMap* pointers[] = {&maps[0], &maps[1], &maps[2]};
  return {to_tensor(concat(pointers, arena)), reference::concat(parts)};
}

PoolOptions pool_options(const LayerCase& c) {
  return {c.option("kernel"), c.option("stride"), c.option("padding")};
}

Outputs coordinate_attention_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x");
  const FoldedConvolution squeeze = fold_batch_norm(c.input("squeeze"), batch_norm_of(c));
  const CoordinateAttentionWeights weights{squeeze.weight,     squeeze.bias,
                                           c.input("rows"),    c.values("rows_bias"),
                                           c.input("columns"), c.values("columns_bias")};
  return in_place(
      x, arena, [&](FeatureMap& map) { CoordinateAttention(weights).apply(map, arena); },
      reference::coordinate_attention(x, weights));
}

Outputs asff_case(const LayerCase& c, Arena& arena) {
  const std::vector<Tensor> levels{c.input("x1"), c.input("x2"), c.input("x3")};
  const std::vector<Tensor> weights{c.input("w1"), c.input("w2"), c.input("w3")};
  std::vector<FeatureMap> maps;
  for (const Tensor& level : levels) maps.push_back(to_feature_map(level, arena));
  const FeatureMap* pointers[] = {&maps[0], &maps[1], &maps[2]};
  return {to_tensor(Asff(weights, c.values("bias"))(pointers, arena)),
          reference::asff(levels, weights, c.values("bias"))};
}

Outputs self_attention_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x");
  const SelfAttentionWeights weights{c.input("f"),
                                     c.input("g"),
                                     c.input("h"),
                                     c.values("f_bias"),
                                     c.values("g_bias"),
                                     c.values("h_bias"),
                                     c.option<float>("gamma")};
  return in_place(
      x, arena, [&](FeatureMap& map) { SelfAttention(weights).apply(map, arena); },
      reference::self_attention(x, weights));
}

Outputs spatial_attention_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x"), weight = c.input("weight");
  return in_place(
      x, arena, [&](FeatureMap& map) { SpatialAttention(weight).apply(map, arena); },
      reference::spatial_attention(x, weight));
}

Outputs channel_attention_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x"), reduce = c.input("reduce"), expand = c.input("expand");
  return in_place(
      x, arena, [&](FeatureMap& map) { ChannelAttention(reduce, expand).apply(map, arena); },
      reference::channel_attention(x, reduce, expand));
}

Outputs mixed_attention_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x"), spatial = c.input("spatial");
  const Tensor reduce = c.input("reduce"), expand = c.input("expand");
  const MixedAttention layer{SpatialAttention(spatial), ChannelAttention(reduce, expand)};
  return in_place(
      x, arena, [&](FeatureMap& map) { layer.apply(map, arena); },
      reference::mixed_attention(x, spatial, reduce, expand));
}

const std::map<std::string, Layer>& layers() {
  static const std::map<std::string, Layer> all{
      {"conv2d", conv2d_case},
      {"conv_transpose2d", conv_transpose2d_case},
      {"linear", linear_case},
      {"batch_norm", batch_norm_case},
      {"activate",
       [](const LayerCase& c, Arena& arena) {
         const Tensor x = scaled(c.input("x"), 6.0F);
         return in_place(
             x, arena, [&](FeatureMap& map) { activate(map, c.activation(), c.slope()); },
             reference::activate(x, c.activation(), c.slope()));
       }},
      {"softmax_channels",
       [](const LayerCase& c, Arena& arena) {
         const Tensor x = scaled(c.input("x"), 6.0F);
         return in_place(x, arena, softmax_channels, reference::softmax_channels(x));
       }},
      {"add",
       [](const LayerCase& c, Arena& arena) {
         const FeatureMap x = to_feature_map(c.input("x"), arena);
         return in_place(
             c.input("y"), arena, [&](FeatureMap& map) { add(map, x); },
             reference::add(c.input("y"), c.input("x")));
       }},
      {"multiply",
       [](const LayerCase& c, Arena& arena) {
         const FeatureMap x = to_feature_map(c.input("x"), arena);
         return in_place(
             c.input("y"), arena, [&](FeatureMap& map) { multiply(map, x); },
             reference::multiply(c.input("y"), c.input("x")));
       }},
      {"concat", concat_case},
      {"slice_channels",
       unary([](const LayerCase& c, const FeatureMap& x,
                Arena& arena) { return slice_channels(x, c.option("first"), c.option("count"), arena); },
             [](const LayerCase& c, const Tensor& x) {
               return reference::slice_channels(x, c.option("first"), c.option("count"));
             })},
      {"max_pool",
       unary([](const LayerCase& c, const FeatureMap& x,
                Arena& arena) { return max_pool(x, pool_options(c), arena); },
             [](const LayerCase& c, const Tensor& x) { return reference::max_pool(x, pool_options(c)); })},
      {"avg_pool", unary(
                       [](const LayerCase& c, const FeatureMap& x, Arena& arena) {
                         return avg_pool(x, pool_options(c), c.option<bool>("count_padding"), arena);
                       },
                       [](const LayerCase& c, const Tensor& x) {
                         return reference::avg_pool(x, pool_options(c), c.option<bool>("count_padding"));
                       })},
      {"adaptive_avg_pool",
       unary([](const LayerCase& c, const FeatureMap& x,
                Arena& arena) { return adaptive_avg_pool(x, c.option("height"), c.option("width"), arena); },
             [](const LayerCase& c, const Tensor& x) {
               return reference::adaptive_avg_pool(x, c.option("height"), c.option("width"));
             })},
      {"global_max_pool",
       unary([](const LayerCase&, const FeatureMap& x, Arena& arena) { return global_max_pool(x, arena); },
             [](const LayerCase&, const Tensor& x) { return reference::global_max_pool(x); })},
      {"upsample_nearest",
       unary([](const LayerCase& c, const FeatureMap& x,
                Arena& arena) { return upsample_nearest(x, c.option("height"), c.option("width"), arena); },
             [](const LayerCase& c, const Tensor& x) {
               return reference::upsample_nearest(x, c.option("height"), c.option("width"));
             })},
      {"upsample_bilinear", unary(
                                [](const LayerCase& c, const FeatureMap& x, Arena& arena) {
                                  return upsample_bilinear(x, c.option("height"), c.option("width"),
                                                           c.option<bool>("align_corners"), arena);
                                },
                                [](const LayerCase& c, const Tensor& x) {
                                  return reference::upsample_bilinear(x, c.option("height"),
                                                                      c.option("width"),
                                                                      c.option<bool>("align_corners"));
                                })},
      {"spatial_attention", spatial_attention_case},
      {"channel_attention", channel_attention_case},
      {"mixed_attention", mixed_attention_case},
      {"coordinate_attention", coordinate_attention_case},
      {"asff", asff_case},
      {"self_attention", self_attention_case},
      {"roi_align", roi_align_case},
      {"multi_scale_roi_align", multi_scale_roi_align_case},
      {"nms", nms_case},
      {"decode_box", decode_box_case},
      {"base_anchors", base_anchors_case},
      {"mask_paste", mask_paste_case},
  };
  return all;
}

TEST(PyTorch, EveryLayerAndItsReferenceGiveThePyTorchOutputs) {
  std::set<std::string> tested;
  for (const LayerCase& c : test::layer_cases()) {
    SCOPED_TRACE(c.options.dump());
    const auto layer = layers().find(c.layer());
    ASSERT_NE(layer, layers().end());
    Arena arena;
    const Outputs outputs = layer->second(c, arena);
    test::expect_close(outputs.fast, c.expected);
    test::expect_close(outputs.naive, c.expected);
    tested.insert(c.layer());
  }
  EXPECT_EQ(tested.size(), layers().size());
}

}  // namespace
}  // namespace penumbra::nn
