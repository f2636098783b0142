#include "nn/layers/activations.h"

#include "nn/layers/exponential.h"

namespace penumbra::nn {

namespace {

template <class Function>
void transform(float* values, std::ptrdiff_t count, Function function) {
  for (std::ptrdiff_t i = 0; i < count; ++i) values[i] = function(values[i]);
}

float hard_sigmoid_of(float x) {
  const float shifted = x + 3.0F;
  const float positive = shifted < 0.0F ? 0.0F : shifted;  // in this form NaN passes
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
      return transform(values, count, hard_sigmoid_of);
    case Activation::hard_swish:
      return transform(values, count, [](float x) { return x * hard_sigmoid_of(x); });
  }
}

void activate(FeatureMap& map, Activation activation, float slope) {
#pragma omp parallel for collapse(3)
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      for (int y = 0; y < map.height(); ++y) {
        activate(map.pixel(n, b, y, 0), static_cast<std::ptrdiff_t>(map.width()) * map.block(), activation,
                 slope);
      }
    }
  }
}

void softmax_channels(FeatureMap& map) {
  const int last_lanes = map.channels() - (map.blocks() - 1) * map.block();
  const auto lanes = [&](int b) { return b + 1 < map.blocks() ? map.block() : last_lanes; };
#pragma omp parallel for collapse(2)
  for (int n = 0; n < map.images(); ++n) {
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        float top = map.pixel(n, 0, y, x)[0], sum = 0.0F;
        for (int b = 0; b < map.blocks(); ++b) {
          const float* f = map.pixel(n, b, y, x);
          for (int c = 0; c < lanes(b); ++c) top = std::max(top, f[c]);
        }
        for (int b = 0; b < map.blocks(); ++b) {
          float* f = map.pixel(n, b, y, x);
          for (int c = 0; c < lanes(b); ++c) sum += f[c] = exponential(f[c] - top);
        }
        for (int b = 0; b < map.blocks(); ++b) {
          float* f = map.pixel(n, b, y, x);
          for (int c = 0; c < lanes(b); ++c) f[c] /= sum;
        }
      }
    }
  }
}

}  // namespace penumbra::nn
