// Naive conv2d, linear, conv_transpose2d and batch_norm.
#include <algorithm>
#include <cmath>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

namespace {

double bias_of(const std::vector<float>& bias, std::int64_t o) {
  return bias.empty() ? 0.0 : bias[static_cast<std::size_t>(o)];
}

}  // namespace

Tensor conv2d(const Tensor& x, const Tensor& weight, const std::vector<float>& bias,
              const Conv2dOptions& options, const Tensor* residual) {
  const std::int64_t images = x.extent(0), height = x.extent(2), width = x.extent(3);
  const std::int64_t outputs = weight.extent(0), kernel_h = weight.extent(2), kernel_w = weight.extent(3);
  const std::int64_t group_inputs = weight.extent(1), group_outputs = outputs / options.groups;
  const int s = options.stride, p = options.padding, d = options.dilation;
  const std::int64_t out_h = (height + 2 * p - d * (kernel_h - 1) - 1) / s + 1;
  const std::int64_t out_w = (width + 2 * p - d * (kernel_w - 1) - 1) / s + 1;
  Tensor y({images, outputs, out_h, out_w});
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t o = 0; o < outputs; ++o) {
      for (std::int64_t i = 0; i < out_h; ++i) {
        for (std::int64_t j = 0; j < out_w; ++j) {
          double sum = bias_of(bias, o);
          const std::int64_t first = o / group_outputs * group_inputs;  // of the group's input channels
          for (std::int64_t k = 0; k < group_inputs; ++k) {
            for (std::int64_t u = 0; u < kernel_h; ++u) {
              for (std::int64_t v = 0; v < kernel_w; ++v) {
                const std::int64_t row = i * s - p + u * d, column = j * s - p + v * d;
                if (row < 0 || column < 0 || row >= height || column >= width) continue;
                sum += static_cast<double>(weight.at(o, k, u, v)) * x.at(n, first + k, row, column);
              }
            }
          }
          if (residual != nullptr) sum += residual->at(n, o, i, j);
          y.at(n, o, i, j) = static_cast<float>(activate(sum, options.activation, options.slope));
        }
      }
    }
  }
  return y;
}

Tensor linear(const Tensor& x, const Tensor& weight, const std::vector<float>& bias, Activation activation) {
  const std::int64_t images = x.extent(0), inputs = x.extent(1), outputs = weight.extent(0);
  Tensor y({images, outputs});
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t o = 0; o < outputs; ++o) {
      double sum = bias_of(bias, o);
      for (std::int64_t i = 0; i < inputs; ++i) {
        sum += static_cast<double>(weight.values[static_cast<std::size_t>(o * inputs + i)]) *
               x.values[static_cast<std::size_t>(n * inputs + i)];
      }
      y.values[static_cast<std::size_t>(n * outputs + o)] =
          static_cast<float>(activate(sum, activation, kDefaultSlope));
    }
  }
  return y;
}

Tensor conv_transpose2d(const Tensor& x, const Tensor& weight, const std::vector<float>& bias,
                        const ConvTranspose2dOptions& options) {
  const std::int64_t images = x.extent(0), channels = x.extent(1), height = x.extent(2), width = x.extent(3);
  const std::int64_t outputs = weight.extent(1), kernel_h = weight.extent(2), kernel_w = weight.extent(3);
  const int s = options.stride, p = options.padding, d = options.dilation;
  const std::int64_t out_h = (height - 1) * s - 2 * p + d * (kernel_h - 1) + options.output_padding + 1;
  const std::int64_t out_w = (width - 1) * s - 2 * p + d * (kernel_w - 1) + options.output_padding + 1;
  Tensor y({images, outputs, out_h, out_w});
  std::vector<double> sums(y.values.size());
  const auto sum_at = [&](std::int64_t n, std::int64_t o, std::int64_t i, std::int64_t j) -> double& {
    return sums[static_cast<std::size_t>(((n * outputs + o) * out_h + i) * out_w + j)];
  };
  for (std::int64_t n = 0; n < images; ++n) {
    for (std::int64_t c = 0; c < channels; ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        for (std::int64_t j = 0; j < width; ++j) {
          for (std::int64_t o = 0; o < outputs; ++o) {
            for (std::int64_t u = 0; u < kernel_h; ++u) {
              for (std::int64_t v = 0; v < kernel_w; ++v) {
                const std::int64_t row = i * s - p + u * d, column = j * s - p + v * d;
                if (row < 0 || column < 0 || row >= out_h || column >= out_w) continue;
                sum_at(n, o, row, column) += static_cast<double>(weight.at(c, o, u, v)) * x.at(n, c, i, j);
              }
            }
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const std::int64_t o = static_cast<std::int64_t>(i) / (out_h * out_w) % outputs;
    y.values[i] = static_cast<float>(activate(sums[i] + bias_of(bias, o), options.activation, options.slope));
  }
  return y;
}

Tensor batch_norm(const Tensor& x, const BatchNorm& norm) {
  Tensor y = x;
  const std::int64_t channels = x.extent(1), area = x.extent(2) * x.extent(3);
  for (std::size_t i = 0; i < y.values.size(); ++i) {
    const auto c = static_cast<std::size_t>(static_cast<std::int64_t>(i) / area % channels);
    const double scale = norm.gamma[c] / std::sqrt(static_cast<double>(norm.variance[c]) + norm.eps);
    y.values[i] =
        static_cast<float>((static_cast<double>(x.values[i]) - norm.mean[c]) * scale + norm.beta[c]);
  }
  return y;
}

}  // namespace penumbra::nn::reference
