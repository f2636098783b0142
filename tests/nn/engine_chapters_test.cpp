// The worked examples of docs/engine: every number there is checked here.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <vector>

#include "nn/base/half.h"
#include "nn/evaluation/coco_rle.h"
#include "nn/io/safetensors.h"
#include "nn/layers/anchor_generator.h"
#include "nn/layers/batch_norm.h"
#include "nn/layers/box_coder.h"
#include "nn/layers/channel_attention.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/mask_paste.h"
#include "nn/layers/nms.h"
#include "nn/layers/packed_weights.h"
#include "nn/layers/roi_align.h"
#include "nn/layers/spatial_attention.h"
#include "nn/simd/low_precision.h"
#include "nn/simd/tile_unit.h"
#include "nn/tensor/memory_plan.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

void expect_values(const Tensor& tensor, const std::vector<float>& expected, float tolerance = 5e-5F) {
  ASSERT_EQ(tensor.values.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(tensor.values[i], expected[i], tolerance) << i;
}

void expect_box(const Box& box, const Box& expected) {
  EXPECT_NEAR(box.x1, expected.x1, 1e-4);
  EXPECT_NEAR(box.y1, expected.y1, 1e-4);
  EXPECT_NEAR(box.x2, expected.x2, 1e-4);
  EXPECT_NEAR(box.y2, expected.y2, 1e-4);
}

TEST(EngineChapters, Tensors) {
  Arena arena;
  FeatureMap map(arena, 1, 20, 3, 5, 1);
  EXPECT_EQ(map.row_stride(), 112);
  EXPECT_EQ(map.block_stride(), 560);
  EXPECT_EQ(map.image_stride(), 1120);
  EXPECT_EQ(map.pixel(0, 18 / kBlock, 1, 2) + 18 % kBlock - map.pixel(0, 0, -1, -1), 834);
}

// arm.md: two pixels of four channels (and four of 0) by two outputs, in the register tile of each kind of
// numbers.
TEST(EngineChapters, Arm) {
  constexpr int kDepth = 8, kPixelStride = 16;
  alignas(64) constexpr float kPixels[2 * kPixelStride] = {1, 2, 3, 4, 0, 0, 0, 0, 0, 0,
                                                           0, 0, 0, 0, 0, 0, 5, 6, 7, 8};
  constexpr float kOutputs[2 * kDepth] = {1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 2, 0};
  WeightSource source{kOutputs, kDepth, {}};
  for (int c = 0; c < kDepth; ++c) source.offsets.push_back(c);
  for (const Precision precision : {Precision::f32, Precision::bf16}) {
    if (!is_supported(precision) || (precision == Precision::bf16 && tile_unit() != nullptr)) continue;
    NumberFormat format;
    format.precision = precision;
    const PackedWeights weights(2, 1, kDepth, source, {}, format);
    alignas(64) std::uint16_t rounded[2 * kPixelStride];
    for (int i = 0; i < 2 * kPixelStride; ++i) rounded[i] = f32_to_bf16(kPixels[i]);
    const std::ptrdiff_t tap = 0;
    float sums[2][2 * kBlock] = {};
    TileArguments a;
    weights.prepare(weights.tile(0), 0, 1, a);
    a.taps = &tap;
    a.input = kPixels;
    if (precision == Precision::bf16) a.input = rounded;
    a.input_pixel_stride = kPixelStride;
    a.output = sums[0];
    a.output_pixel_stride = 2 * kBlock;
    a.output_block_stride = kBlock;
    weights.kernel(weights.tile(0), 2)(a);
    EXPECT_EQ(std::vector<float>({sums[0][0], sums[0][1]}), std::vector<float>({5, 8}))
        << to_string(precision);
    EXPECT_EQ(std::vector<float>({sums[1][0], sums[1][1]}), std::vector<float>({13, 20}))
        << to_string(precision);
  }
}

#if defined(__x86_64__)
// One TDPBF16PS: a tile of one pixel, four channels, one output. By emulation, which tile_unit_test holds to
// the processor.
float tile_product(const std::array<float, 4>& x, const std::array<float, 4>& w, float c) {
  alignas(64) std::array<std::byte, kTileRows * kLineBytes> a{}, b{}, sums{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto upper_half = [](float value) { return std::bit_cast<std::array<std::byte, 4>>(value); };
    std::memcpy(&a[2 * k], &upper_half(x[k])[2], 2);
    std::memcpy(&b[k / 2 * kLineBytes + k % 2 * 2], &upper_half(w[k])[2], 2);
  }
  std::memcpy(sums.data(), &c, 4);
  amx_emulated::kTileUnit.tile_product({Precision::bf16, 1, 8, 4, a.data(), b.data(), sums.data()});
  std::memcpy(&c, sums.data(), 4);
  return c;
}

TEST(EngineChapters, TileUnits) {
  if (!is_supported(Isa::amx_emulated)) GTEST_SKIP() << "no AVX2 here";
  EXPECT_EQ(tile_product({1, 2, 3, 4}, {0.5F, -1, 2, 0.25F}, 10), 15.5F);
  EXPECT_EQ(tile_product({0x1p24F, 1, -0x1p24F, 1}, {1, 1, 1, 1}, 0), 2.0F);
  EXPECT_EQ((((0x1p24F + 1.0F) - 0x1p24F) + 1.0F), 1.0F);
  Arena arena;
  const FeatureMap map(arena, 1, 70, 3, 5, 1, Numbers{Precision::bf16, {}});
  EXPECT_EQ(map.blocks(), 3);
  EXPECT_EQ(map.block(), 32);
  EXPECT_EQ(map.line(0, 1, 2, 3) - map.line(0, 1, 2, 2), kLineBytes);
}
#endif

TEST(EngineChapters, Memory) {
  const std::vector<BufferLifetime> chain{{64, 0, 2}, {640, 1, 3}, {256, 2, 4}, {320, 3, 5}, {128, 4, 6}};
  const MemoryPlan plan = plan_memory(chain);
  EXPECT_EQ(plan.offsets, (std::vector<std::size_t>{640, 0, 640, 0, 320}));
  EXPECT_EQ(plan.bytes, 896U);
  EXPECT_EQ(most_live_bytes(chain), 896U);
  EXPECT_EQ(64 + 640 + 256 + 320 + 128, 1408);
}

TEST(EngineChapters, Convolution) {
  Arena arena;
  const FeatureMap x = to_feature_map(Tensor({1, 1, 3, 3}, {1, 2, 3, 4, 5, 6, 7, 8, 9}), arena);
  expect_values(to_tensor(Conv2d(Tensor({1, 1, 2, 2}, {1, 2, 3, 4}), {}, {})(x, arena)), {37, 47, 67, 77});
}

TEST(EngineChapters, BatchNorm) {
  const FoldedConvolution folded = fold_batch_norm(Tensor({1, 1, 1, 1}, {2}), {{3}, {1}, {4}, {0.25F}, 0.0F});
  EXPECT_EQ(folded.weight.values, std::vector<float>{12});
  EXPECT_EQ(folded.bias, std::vector<float>{-23});
}

TEST(EngineChapters, Attention) {
  const Tensor f({1, 2, 1, 2}, {1, 3, 5, 3});
  Arena arena;
  FeatureMap map = to_feature_map(f, arena);
  SpatialAttention(Tensor({1, 2, 1, 1}, {1, -1})).apply(map, arena);
  expect_values(to_tensor(map), {0.8808F, 1.5F, 4.4040F, 1.5F});
  map = to_feature_map(f, arena);
  ChannelAttention(Tensor({1, 2}, {1, 0}), Tensor({2, 1}, {1, -1})).apply(map, arena);
  expect_values(to_tensor(map), {0.9933F, 2.9799F, 0.0335F, 0.0201F});
}

TEST(EngineChapters, Boxes) {
  const std::vector<float> ratios{0.5F, 1.0F, 2.0F};
  const Box base = base_anchors(32.0F, ratios).front();
  expect_box(base, {-23, -11, 23, 11});
  const Box anchor = shift(base, 3 * 4, 2 * 4);
  expect_box(anchor, {-11, -3, 35, 19});
  const Box box = decode_box(anchor, 0.5F, 0.0F, std::log(2.0F), 0.0F, {});
  expect_box(box, {-11, -3, 81, 19});
  expect_box(clip(box, 64, 48), {0, 0, 64, 19});

  const std::vector<Box> boxes{{0, 0, 10, 10}, {0, 0, 10, 5}};
  EXPECT_FLOAT_EQ(iou(boxes[0], boxes[1]), 0.5F);
  const std::vector<float> scores{0.9F, 0.8F};
  EXPECT_EQ(batched_nms(boxes, scores, std::vector{0, 0}, 0.4F, 10), std::vector{0});
  EXPECT_EQ(batched_nms(boxes, scores, std::vector{0, 0}, 0.5F, 10), (std::vector{0, 1}));
}

TEST(EngineChapters, RoiAlign) {
  Tensor f({1, 1, 4, 4});
  std::iota(f.values.begin(), f.values.end(), 0.0F);
  Arena arena;
  const FeatureMap map = to_feature_map(f, arena);
  const PyramidLevel level{&map, 1.0F};
  const std::vector<Box> regions{{1, 1, 3, 3}, {2, 2, 6, 6}};
  RoiAlignOptions options;
  options.size = 2;
  options.sampling = 2;
  expect_values(to_tensor(multi_scale_roi_align({&level, 1}, regions, options, arena)),
                {7.5F, 8.5F, 11.5F, 12.5F, 13.75F, 0, 0, 0});
  EXPECT_EQ(roi_level({0, 0, 224, 224}, 4), 4 - 2);
  EXPECT_EQ(roi_level({0, 0, 223, 223}, 4), 3 - 2);
}

TEST(EngineChapters, Masks) {
  const std::vector<float> ones(4, 1.0F);
  const Mask mask = paste_mask(ones, 2, {4, 4, 8, 8}, 20, 20);
  EXPECT_EQ(mask.x, 2);
  EXPECT_EQ(mask.width, 9);
  EXPECT_EQ(std::accumulate(mask.bits.begin(), mask.bits.end(), 0), 21);
  for (int y = 4; y <= 8; ++y) {
    for (int x = 4; x <= 8; ++x) {
      const bool corner = (x == 4 || x == 8) && (y == 4 || y == 8);
      EXPECT_EQ(mask.contains(x, y), !corner) << x << ", " << y;
    }
  }
  EXPECT_EQ(encode_runs(mask_runs(Mask{1, 1, 2, 2, {1, 1, 1, 1}}, 4, 4)), "52203");
}

TEST(EngineChapters, Checkpoints) {
  const std::string header = R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})";
  std::string bytes("\x36\0\0\0\0\0\0\0", 8);
  bytes += header;
  bytes.append("\x00\x00\x80\x3f\x00\x00\x00\xc0", 8);
  EXPECT_EQ(header.size(), 54U);
  EXPECT_EQ(bytes.size(), 70U);
  const test::TemporaryDirectory folder;
  std::ofstream(folder / "a.safetensors", std::ios::binary) << bytes;
  EXPECT_EQ(read_safetensors(folder / "a.safetensors").tensors.at("a").to_f32(), (std::vector<float>{1, -2}));
}

}  // namespace
}  // namespace penumbra::nn
