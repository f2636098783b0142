// Naive spatial and channel attention.
#include <algorithm>
#include <cmath>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

namespace {

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

}  // namespace

Tensor spatial_attention(const Tensor& x, const Tensor& weight) {
  const std::int64_t images = x.extent(0), channels = x.extent(1), height = x.extent(2), width = x.extent(3);
  Tensor pooled({images, 2, height, width});
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t i = 0; i < height; ++i) {
      for (std::int64_t j = 0; j < width; ++j) {
        double sum = 0.0;
        float top = x.at(n, 0, i, j);
        for (std::int64_t c = 0; c < channels; ++c) {
          top = std::max(top, x.at(n, c, i, j));
          sum += x.at(n, c, i, j);
        }
        pooled.at(n, 0, i, j) = top;
        pooled.at(n, 1, i, j) = static_cast<float>(sum / static_cast<double>(channels));
      }
    }
  }
  Conv2dOptions options;
  options.padding = static_cast<int>(weight.extent(2)) / 2;
  const Tensor logits = conv2d(pooled, weight, {}, options);
  Tensor y = x;
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t c = 0; c < channels; ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        for (std::int64_t j = 0; j < width; ++j) {
          y.at(n, c, i, j) = static_cast<float>(x.at(n, c, i, j) * sigmoid(logits.at(n, 0, i, j)));
        }
      }
    }
  }
  return y;
}

Tensor channel_attention(const Tensor& x, const Tensor& reduce, const Tensor& expand) {
  const std::int64_t images = x.extent(0), channels = x.extent(1), height = x.extent(2), width = x.extent(3);
  Tensor top({images, channels}), mean({images, channels});
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t c = 0; c < channels; ++c) {
      double sum = 0.0;
      float best = x.at(n, c, 0, 0);
      for (std::int64_t i = 0; i < height; ++i) {
        for (std::int64_t j = 0; j < width; ++j) {
          best = std::max(best, x.at(n, c, i, j));
          sum += x.at(n, c, i, j);
        }
      }
      top.values[static_cast<std::size_t>(n * channels + c)] = best;
      mean.values[static_cast<std::size_t>(n * channels + c)] =
          static_cast<float>(sum / static_cast<double>(height * width));
    }
  }
  const auto mlp = [&](const Tensor& v) {
    return linear(linear(v, reduce, {}, Activation::relu), expand, {}, Activation::none);
  };
  const Tensor from_top = mlp(top), from_mean = mlp(mean);
  Tensor y = x;
  for (std::size_t i = 0; i < y.values.size(); ++i) {
    const std::size_t channel =
        i / static_cast<std::size_t>(height * width);  // of all images, one after the other
    y.values[i] *= static_cast<float>(sigmoid(from_top.values[channel] + from_mean.values[channel]));
  }
  return y;
}

}  // namespace penumbra::nn::reference
