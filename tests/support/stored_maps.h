// Maps in any numbers, and comparisons of what is stored in them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "nn/layers/narrow_maps.h"
#include "tests/support/tensors.h"

namespace penumbra::test {

using nn::Arena;
using nn::FeatureMap;
using nn::Numbers;
using nn::Precision;
using nn::Tensor;

inline constexpr Numbers kBf16{Precision::bf16, {}};
inline constexpr Numbers kBytes{Precision::int8, {1.0F / 128, 120}};
inline constexpr Numbers kAllNumbers[] = {{}, kBf16, kBytes};

inline Tensor values_of(const FeatureMap& map, Arena& arena) {
  return nn::to_tensor(map.numbers() == Numbers{} ? nn::with_border(map, arena, 0)
                                                  : nn::in_numbers(map, {}, arena));
}

// Within the rounding of `numbers` of what the reference says.
inline void expect_stored(const FeatureMap& map, const Tensor& expected, const Numbers& numbers,
                          Arena& arena) {
  ASSERT_EQ(map.numbers(), numbers);
  if (numbers.precision == Precision::f32) {
    expect_close(nn::to_tensor(map), expected, 2e-5F);
    return;
  }
  const Tensor found = values_of(map, arena);
  ASSERT_EQ(found.shape, expected.shape);
  const nn::Quantisation& q = numbers.quantisation;
  float largest = 0.0F;
  for (const float value : expected.values) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0; i < expected.values.size(); ++i) {
    float value = expected.values[i], error = std::abs(value) / 256.0F;
    if (numbers.precision == Precision::int8) {
      value = std::clamp(value, -q.scale * static_cast<float>(q.zero),
                         q.scale * static_cast<float>(255 - q.zero));
      error = q.scale / 2;
    }
    ASSERT_NEAR(found.values[i], value, error + 2e-5F * largest) << i;
  }
}

// Both must leave the same bytes.
inline void expect_same_bits(const FeatureMap& a, const FeatureMap& b) {
  for (int n = 0; n < a.images(); ++n) {
    for (int c = 0; c < a.channels(); ++c) {
      const int block = c / a.block(), lane = c % a.block() * nn::element_size(a.numbers().precision);
      for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
          ASSERT_EQ(std::memcmp(a.line(n, block, y, x) + lane, b.line(n, block, y, x) + lane,
                                static_cast<std::size_t>(nn::element_size(a.numbers().precision))),
                    0);
        }
      }
    }
  }
}

}  // namespace penumbra::test
