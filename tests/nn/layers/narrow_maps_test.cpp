// Narrow maps on a tile unit's emulation: conversions, pooling, regions and sums.
#include "nn/layers/narrow_maps.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/pooling.h"
#include "nn/layers/roi_align.h"
#include "nn/simd/isa.h"
#include "nn/simd/low_precision.h"
#include "tests/support/rounded_numbers.h"
#include "tests/support/stored_maps.h"

namespace penumbra::nn {
namespace {

using test::expect_close;
using test::expect_stored;
using test::kAllNumbers;
using test::kBf16;
using test::kBytes;
using test::random_tensor;
using test::random_vector;
using test::rounded_input;
using test::values_of;

class NarrowMapsTest : public ::testing::TestWithParam<Precision> {
 protected:
  void SetUp() override { use_isa(Isa::amx_emulated); }
  void TearDown() override { use_isa(before_); }
  Numbers numbers() const { return GetParam() == Precision::bf16 ? kBf16 : kBytes; }

 private:
  Isa before_ = current_isa();
};

TEST_P(NarrowMapsTest, MaximaAndSubsamplesKeepTheNumbers) {
  const Tensor x = rounded_input(random_tensor({2, 70, 9, 13}, 1), numbers());
  Arena arena;
  const FeatureMap map = in_numbers(to_feature_map(x, arena), numbers(), arena);
  for (const PoolOptions& options : {PoolOptions{3, 2, 1}, PoolOptions{1, 2, 0}, PoolOptions{5, 1, 2}}) {
    const FeatureMap y = max_pool(map, options, arena, 1);
    ASSERT_EQ(y.numbers(), numbers());
    EXPECT_EQ(values_of(y, arena).values,
              to_tensor(max_pool(to_feature_map(x, arena), options, arena)).values);
  }
  EXPECT_THROW(global_avg_pool(map, arena), InputError);
}

TEST_P(NarrowMapsTest, RegionsAreReadFromNarrowMaps) {
  const Tensor x = rounded_input(random_tensor({1, 70, 20, 30}, 1), numbers());
  Arena arena;
  const FeatureMap wide = to_feature_map(x, arena), narrow = in_numbers(wide, numbers(), arena);
  const std::vector<Box> regions{{3, 4, 60, 50}, {-9, 0, 7, 300}, {100, 10, 100, 10}};
  const PyramidLevel wide_level{&wide, 0.25F}, narrow_level{&narrow, 0.25F};
  const Tensor expected = to_tensor(multi_scale_roi_align({&wide_level, 1}, regions, {7, 2}, arena));
  for (const Numbers& output : kAllNumbers) {
    const FeatureMap y = multi_scale_roi_align({&narrow_level, 1}, regions, {7, 2}, arena, 1, 5, output);
    EXPECT_EQ(y.batch().capacity, 5);
    expect_stored(y, expected, output, arena);
  }
}

TEST_P(NarrowMapsTest, SumsWithUpsampledMaps) {
  const Tensor fine = rounded_input(random_tensor({2, 48, 7, 13}, 1), kBf16);
  const Tensor coarse = rounded_input(random_tensor({2, 48, 4, 6}, 2), numbers());
  Tensor expected = fine;
  for (int n = 0; n < 2; ++n) {
    for (int c = 0; c < 48; ++c) {
      for (int y = 0; y < 7; ++y) {
        for (int x = 0; x < 13; ++x) expected.at(n, c, y, x) += coarse.at(n, c, y * 4 / 7, x * 6 / 13);
      }
    }
  }
  Arena arena;
  for (const Numbers& output : kAllNumbers) {
    const FeatureMap sum =
        sum_with_upsampled(in_numbers(to_feature_map(fine, arena), kBf16, arena),
                           in_numbers(to_feature_map(coarse, arena), numbers(), arena), output, arena, 1);
    expect_stored(sum, expected, output, arena);
  }
}

TEST_P(NarrowMapsTest, RowsAreMultipliedByAVector) {
  const Tensor x = rounded_input(random_tensor({2, 48, 3, 13}, 1), numbers());
  const std::vector<float> weights = random_vector(48, 2);
  Arena arena;
  const FeatureMap map = in_numbers(to_feature_map(x, arena, 1), numbers(), arena);
  std::vector<float> dots(13);
  dot_row(map, 1, 2, weights.data(), dots.data());
  for (int column = 0; column < 13; ++column) {
    double expected = 0.0;
    for (int c = 0; c < 48; ++c)
      expected += double{weights[static_cast<std::size_t>(c)]} * x.at(1, c, 2, column);
    EXPECT_NEAR(dots[static_cast<std::size_t>(column)], expected, 1e-5);
  }
}

TEST_P(NarrowMapsTest, NumbersAreConvertedWithTheirBorders) {
  const Tensor x = random_tensor({2, 37, 3, 5}, 1);
  Arena arena;
  const FeatureMap wide = to_feature_map(x, arena, 2), narrow = in_numbers(wide, numbers(), arena);
  EXPECT_EQ(narrow.border(), 2);
  EXPECT_EQ(narrow.block(), line_channels(GetParam()));
  const FeatureMap back = in_numbers(narrow, {}, arena);
  expect_close(to_tensor(back), rounded_input(x, numbers()), 1e-6F);
  for (int c = 0; c < 37; ++c) EXPECT_EQ(back.pixel(1, c / kBlock, -2, 6)[c % kBlock], 0.0F);
  const int zero = GetParam() == Precision::int8 ? numbers().quantisation.zero : 0;
  EXPECT_EQ(static_cast<int>(*narrow.line(1, 0, 4, -1)), zero);
}

INSTANTIATE_TEST_SUITE_P(Every, NarrowMapsTest, ::testing::Values(Precision::bf16, Precision::int8),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST(NarrowMaps, NeedATileUnit) {
  const Isa before = current_isa();
  use_isa(Isa::baseline);
  Arena arena;
  const FeatureMap map = to_feature_map(random_tensor({1, 3, 2, 2}, 1), arena);
  EXPECT_THROW(in_numbers(map, kBf16, arena), Error);
  use_isa(Isa::amx_emulated);
  EXPECT_THROW(split_image(map, arena), InputError);
  use_isa(before);
}

}  // namespace
}  // namespace penumbra::nn
