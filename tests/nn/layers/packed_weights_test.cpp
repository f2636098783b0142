#include "nn/layers/packed_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/counter_random.h"
#include "nn/base/half.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {
namespace {

struct Case {
  int outputs, taps, depth;
};

// Number g of the group that the weight of output o at tap t and channel c belongs to.
std::ptrdiff_t place_of(const PackedWeights& packed, int o, int t, int c) {
  const int group = packed.group(), first = o / packed.tile_channels() * packed.tile_channels();
  const WeightTile tile = packed.tile(o / packed.tile_channels());
  const std::ptrdiff_t k = std::ptrdiff_t{t} * packed.depth() + c;
  return (k / group * tile.channels + (o - first)) * group + k % group;
}

// In a tensor [outputs][taps * depth] that lies backwards, with every fifth weight left out.
void check(const Case& shape, Precision precision) {
  if (!is_supported(precision)) return;
  const int outputs = shape.outputs, taps = shape.taps, depth = shape.depth;
  const int row = taps * depth;
  std::vector<float> values(static_cast<std::size_t>(outputs * row));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = counter_uniform_f32(3, static_cast<std::uint32_t>(i)) - 0.5F;
  WeightSource source{values.data(), row, {}};
  for (int k = 0; k < row; ++k) source.offsets.push_back(k % 5 == 4 ? WeightSource::kNone : row - 1 - k);
  NumberFormat format;
  format.precision = precision;
  format.input = {0.25F, 3};
  const std::vector<float> bias(static_cast<std::size_t>(outputs), 0.5F);
  const PackedWeights packed(outputs, taps, depth, source, bias, format);
  const int padded = (outputs + 15) / 16 * 16;
  for (int o = 0; o < padded; ++o) {
    const WeightTile tile = packed.tile(o / packed.tile_channels());
    const int lane = o % packed.tile_channels();
    const auto weight = [&](int k) {
      return o < outputs && k % 5 != 4 ? values[static_cast<std::size_t>(o * row + row - 1 - k)] : 0.0F;
    };
    float largest = 0.0F;
    double sum = 0.0;
    for (int k = 0; k < row; ++k) largest = std::max(largest, std::abs(weight(k)));
    for (int k = 0; k < row; ++k) {
      const std::ptrdiff_t place = place_of(packed, o, k / depth, k % depth);
      if (precision == Precision::f32) {
        ASSERT_EQ(reinterpret_cast<const float*>(tile.weights)[place], weight(k)) << o << " " << k;
      } else if (precision == Precision::bf16) {
        ASSERT_EQ(reinterpret_cast<const std::uint16_t*>(tile.weights)[place], f32_to_bf16(weight(k)));
      } else {
        const double whole = largest > 0.0F ? std::nearbyint(weight(k) * (127.0F / largest)) : 0.0;
        ASSERT_EQ(reinterpret_cast<const std::int8_t*>(tile.weights)[place], whole) << o << " " << k;
        sum += whole;
      }
    }
    const float start = o < outputs ? 0.5F : 0.0F;
    if (precision != Precision::int8) {
      ASSERT_EQ(tile.bias[lane], start);
    } else {
      const int zero = 3 - low_precision_kernels(precision).tile.input_offset;
      ASSERT_FLOAT_EQ(tile.scale[lane], 0.25F * largest / 127.0F);
      ASSERT_FLOAT_EQ(tile.bias[lane],
                      start - static_cast<float>(static_cast<double>(tile.scale[lane]) * zero * sum));
    }
  }
}

TEST(PackedWeights, LieInTheTilesOrder) {
  const int threads = thread_count();
  for (const int count : {1, 3}) {
    set_thread_count(count);
    for (const Case& shape :
         {Case{1, 1, 4}, Case{16, 3, 16}, Case{33, 2, 28}, Case{70, 9, 16}, Case{200, 40, 16}}) {
      for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
        if (shape.depth % (4 * channel_group(precision)) != 0) continue;
        check(shape, precision);
      }
    }
  }
  set_thread_count(threads);
}

TEST(PackedWeights, WeightsOfZeroHaveNoScaleToDivideBy) {
  if (!is_supported(Precision::int8)) GTEST_SKIP();
  const std::vector<float> zeros(16, 0.0F);
  WeightSource source{zeros.data(), 16, {}};
  for (int k = 0; k < 16; ++k) source.offsets.push_back(k);
  NumberFormat format;
  format.precision = Precision::int8;
  const PackedWeights packed(1, 1, 16, source, {}, format);
  EXPECT_EQ(packed.tile(0).scale[0], 0.0F);
  EXPECT_EQ(packed.tile(0).bias[0], 0.0F);
}

}  // namespace
}  // namespace penumbra::nn
