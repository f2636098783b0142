// Tensors rounded as layers of bf16 and 8-bit numbers round them.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "nn/simd/numbers.h"
#include "nn/tensor/tensor.h"

namespace penumbra::test {

inline float as_bf16(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>((bits + 0x7FFFU + ((bits >> 16) & 1U)) & 0xFFFF0000U);
}

inline nn::Tensor rounded_to_bf16(nn::Tensor tensor) {
  for (float& value : tensor.values) value = as_bf16(value);
  return tensor;
}

inline nn::Tensor quantised_input(nn::Tensor tensor, const nn::Quantisation& q) {
  for (float& value : tensor.values) {
    const float whole = std::nearbyint(value / q.scale + static_cast<float>(q.zero));
    value = (std::min(std::max(whole, 0.0F), 255.0F) - static_cast<float>(q.zero)) * q.scale;
  }
  return tensor;
}

// `scale_of(i)` names the scale that weight i shares with others.
template <class ScaleOf>
nn::Tensor quantised_weight(nn::Tensor weight, ScaleOf scale_of) {
  std::map<std::int64_t, float> largest;
  for (std::size_t i = 0; i < weight.values.size(); ++i) {
    float& most = largest[scale_of(static_cast<std::int64_t>(i))];
    most = std::max(most, std::abs(weight.values[i]));
  }
  for (std::size_t i = 0; i < weight.values.size(); ++i) {
    const float most = largest[scale_of(static_cast<std::int64_t>(i))];
    weight.values[i] = std::nearbyint(weight.values[i] * (127.0F / most)) * (most / 127.0F);
  }
  return weight;
}

// A scale for each output channel, the first axis.
inline nn::Tensor quantised_weight(const nn::Tensor& weight) {
  const std::int64_t row = nn::elements(weight.shape) / weight.shape.front();
  return quantised_weight(weight, [&](std::int64_t i) { return i / row; });
}

inline nn::Tensor rounded_input(const nn::Tensor& tensor, const nn::Numbers& numbers) {
  if (numbers.precision == nn::Precision::f32) return tensor;
  return numbers.precision == nn::Precision::bf16 ? rounded_to_bf16(tensor)
                                                  : quantised_input(tensor, numbers.quantisation);
}

inline nn::Tensor rounded_weight(const nn::Tensor& weight, nn::Precision precision) {
  return precision == nn::Precision::bf16 ? rounded_to_bf16(weight) : quantised_weight(weight);
}

}  // namespace penumbra::test
