// Activation functions over a run of values: plain loops that the compiler turns into vector instructions.

#include "nn/simd/exponential.h"
#include "nn/simd/kernels/kernels.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

template <class Function>
void transform(float* values, std::ptrdiff_t count, Function function) {
  for (std::ptrdiff_t i = 0; i < count; ++i) values[i] = function(values[i]);
}

// Comparisons in the form in which NaN stays NaN.
float hard_sigmoid(float x) {
  const float shifted = x + 3.0F;
  const float positive = shifted < 0.0F ? 0.0F : shifted;
  return (positive > 6.0F ? 6.0F : positive) * (1.0F / 6.0F);
}

}  // namespace

void activate(float* values, std::ptrdiff_t count, Activation activation, float slope) {
  switch (activation) {
    case Activation::none:
      return;
    case Activation::relu:
      return transform(values, count, [](float x) { return x < 0.0F ? 0.0F : x; });
    case Activation::leaky_relu:
      return transform(values, count, [slope](float x) { return x > 0.0F ? x : slope * x; });
    case Activation::sigmoid:
      return transform(values, count, [](float x) { return 1.0F / (1.0F + exponential(-x)); });
    case Activation::silu:
      return transform(values, count, [](float x) { return x / (1.0F + exponential(-x)); });
    case Activation::hard_sigmoid:
      return transform(values, count, hard_sigmoid);
    case Activation::hard_swish:
      return transform(values, count, [](float x) { return x * hard_sigmoid(x); });
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
