// Random tensors and comparisons for the tests of layers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "nn/base/counter_random.h"
#include "nn/tensor/tensor.h"

namespace penumbra::test {

// Uniform in [-1, 1), from the generator that Python shares.
inline nn::Tensor random_tensor(const nn::Shape& shape, std::uint32_t seed) {
  nn::Tensor tensor(shape);
  for (std::size_t i = 0; i < tensor.values.size(); ++i) {
    tensor.values[i] = counter_uniform_f32(seed, static_cast<std::uint32_t>(i));
  }
  return tensor;
}

inline std::vector<float> random_vector(std::int64_t size, std::uint32_t seed) {
  return random_tensor({size}, seed).values;
}

// Shapes equal, and values equal to `tolerance` times the largest expected value.
inline void expect_close(const nn::Tensor& found, const nn::Tensor& expected, float tolerance = 1e-5F) {
  ASSERT_EQ(found.shape, expected.shape);
  float largest = 0.0F, error = 0.0F;
  for (std::size_t i = 0; i < expected.values.size(); ++i) {
    ASSERT_TRUE(std::isfinite(found.values[i])) << "value " << i;
    largest = std::max(largest, std::abs(expected.values[i]));
    error = std::max(error, std::abs(found.values[i] - expected.values[i]));
  }
  EXPECT_LE(error, tolerance * largest) << "shape " << nn::to_string(expected.shape);
}

// A whole number from lowest to highest, both included.
inline int pick(std::mt19937& random, int lowest, int highest) {
  return std::uniform_int_distribution<int>(lowest, highest)(random);
}

}  // namespace penumbra::test
