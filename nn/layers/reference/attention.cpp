// Naive attention of every kind, and ASFF.
#include <algorithm>
#include <cmath>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

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

Tensor mixed_attention(const Tensor& x, const Tensor& spatial, const Tensor& reduce, const Tensor& expand) {
  return channel_attention(spatial_attention(x, spatial), reduce, expand);
}

Tensor coordinate_attention(const Tensor& x, const CoordinateAttentionWeights& weights) {
  const std::int64_t images = x.extent(0), channels = x.extent(1), height = x.extent(2), width = x.extent(3);
  // [z^h ; z^w], joined along their length as the paper does it.
  Tensor pooled({images, channels, 1, height + width});
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t c = 0; c < channels; ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        double sum = 0.0;
        for (std::int64_t j = 0; j < width; ++j) sum += x.at(n, c, i, j);
        pooled.at(n, c, 0, i) = static_cast<float>(sum / static_cast<double>(width));
      }
      for (std::int64_t j = 0; j < width; ++j) {
        double sum = 0.0;
        for (std::int64_t i = 0; i < height; ++i) sum += x.at(n, c, i, j);
        pooled.at(n, c, 0, height + j) = static_cast<float>(sum / static_cast<double>(height));
      }
    }
  }
  const Tensor f =
      activate(conv2d(pooled, weights.squeeze, weights.squeeze_bias, {}), Activation::hard_swish);
  const Tensor rows =
      activate(conv2d(f, weights.expand_rows, weights.expand_rows_bias, {}), Activation::sigmoid);
  const Tensor columns =
      activate(conv2d(f, weights.expand_columns, weights.expand_columns_bias, {}), Activation::sigmoid);
  Tensor y = x;
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t c = 0; c < channels; ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        for (std::int64_t j = 0; j < width; ++j) {
          y.at(n, c, i, j) *= rows.at(n, c, 0, i) * columns.at(n, c, 0, height + j);
        }
      }
    }
  }
  return y;
}

Tensor asff(std::span<const Tensor> levels, std::span<const Tensor> weights, const std::vector<float>& bias) {
  std::vector<Tensor> logits;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    logits.push_back(conv2d(levels[k], weights[k], bias.empty() ? bias : std::vector<float>{bias[k]}, {}));
  }
  const Tensor shares = softmax_channels(concat(logits));
  Tensor y(levels.front().shape);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    y = add(y, multiply(levels[k], slice_channels(shares, static_cast<std::int64_t>(k), 1)));
  }
  return y;
}

Tensor self_attention(const Tensor& x, const SelfAttentionWeights& weights) {
  const Tensor f = conv2d(x, weights.f, weights.f_bias, {}), g = conv2d(x, weights.g, weights.g_bias, {});
  const Tensor h = conv2d(x, weights.h, weights.h_bias, {});
  const std::int64_t channels = x.extent(1), pixels = x.extent(2) * x.extent(3);
  const auto value = [&](const Tensor& t, std::int64_t n, std::int64_t c, std::int64_t pixel) {
    return static_cast<double>(t.values[static_cast<std::size_t>((n * t.extent(1) + c) * pixels + pixel)]);
  };
  Tensor y = x;
  for (std::int64_t n = 0; n < x.extent(0); ++n) {
    for (std::int64_t j = 0; j < pixels; ++j) {
      std::vector<double> beta(static_cast<std::size_t>(pixels), 0.0);
      for (std::int64_t i = 0; i < pixels; ++i) {
        for (std::int64_t d = 0; d < f.extent(1); ++d) {
          beta[static_cast<std::size_t>(i)] += value(f, n, d, i) * value(g, n, d, j);
        }
      }
      const double top = *std::max_element(beta.begin(), beta.end());
      double sum = 0.0;
      for (double& b : beta) sum += b = std::exp(b - top);
      for (std::int64_t c = 0; c < channels; ++c) {
        double o = 0.0;
        for (std::int64_t i = 0; i < pixels; ++i)
          o += beta[static_cast<std::size_t>(i)] / sum * value(h, n, c, i);
        y.values[static_cast<std::size_t>((n * channels + c) * pixels + j)] =
            static_cast<float>(weights.gamma * o + value(x, n, c, j));
      }
    }
  }
  return y;
}

}  // namespace penumbra::nn::reference
