// Naive activations, concat, slice_channels, add and multiply.
#include <algorithm>
#include <cmath>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

namespace {

double hard_sigmoid(double x) { return std::min(std::max(x + 3.0, 0.0), 6.0) / 6.0; }

template <class Operation>
Tensor broadcast(const Tensor& y, const Tensor& x, Operation operation) {
  Tensor result = y;
  const auto index = [&](std::size_t axis, std::int64_t i) { return x.extent(axis) == 1 ? 0 : i; };
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < y.extent(1); ++c) {
      for (std::int64_t i = 0; i < y.extent(2); ++i) {
        for (std::int64_t j = 0; j < y.extent(3); ++j) {
          result.at(n, c, i, j) =
              operation(y.at(n, c, i, j), x.at(index(0, n), index(1, c), index(2, i), index(3, j)));
        }
      }
    }
  }
  return result;
}

}  // namespace

double activate(double x, Activation activation, float slope) {
  switch (activation) {
    case Activation::none:
      return x;
    case Activation::relu:
      return std::max(x, 0.0);
    case Activation::leaky_relu:
      return x > 0.0 ? x : slope * x;
    case Activation::sigmoid:
      return sigmoid(x);
    case Activation::silu:
      return x * sigmoid(x);
    case Activation::hard_sigmoid:
      return hard_sigmoid(x);
    case Activation::hard_swish:
      return x * hard_sigmoid(x);
  }
  return x;
}

Tensor activate(const Tensor& x, Activation activation, float slope) {
  Tensor y = x;
  for (float& value : y.values) value = static_cast<float>(activate(double{value}, activation, slope));
  return y;
}

Tensor softmax_channels(const Tensor& x) {
  Tensor y = x;
  for (std::int64_t n = 0; n < x.extent(0); ++n) {
    for (std::int64_t i = 0; i < x.extent(2); ++i) {
      for (std::int64_t j = 0; j < x.extent(3); ++j) {
        double top = x.at(n, 0, i, j), sum = 0.0;
        for (std::int64_t c = 0; c < x.extent(1); ++c) top = std::max(top, double{x.at(n, c, i, j)});
        for (std::int64_t c = 0; c < x.extent(1); ++c) sum += std::exp(x.at(n, c, i, j) - top);
        for (std::int64_t c = 0; c < x.extent(1); ++c) {
          y.at(n, c, i, j) = static_cast<float>(std::exp(x.at(n, c, i, j) - top) / sum);
        }
      }
    }
  }
  return y;
}

Tensor concat(std::span<const Tensor> parts) {
  const Tensor& first = parts.front();
  std::int64_t channels = 0;
  for (const Tensor& part : parts) channels += part.extent(1);
  Tensor y({first.extent(0), channels, first.extent(2), first.extent(3)});
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    std::int64_t start = 0;
    for (const Tensor& part : parts) {
      for (std::int64_t c = 0; c < part.extent(1); ++c) {
        for (std::int64_t i = 0; i < y.extent(2); ++i) {
          for (std::int64_t j = 0; j < y.extent(3); ++j) y.at(n, start + c, i, j) = part.at(n, c, i, j);
        }
      }
      start += part.extent(1);
    }
  }
  return y;
}

Tensor slice_channels(const Tensor& x, std::int64_t first, std::int64_t count) {
  Tensor y({x.extent(0), count, x.extent(2), x.extent(3)});
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < count; ++c) {
      for (std::int64_t i = 0; i < y.extent(2); ++i) {
        for (std::int64_t j = 0; j < y.extent(3); ++j) y.at(n, c, i, j) = x.at(n, first + c, i, j);
      }
    }
  }
  return y;
}

Tensor add(const Tensor& y, const Tensor& x) {
  return broadcast(y, x, [](float a, float b) { return a + b; });
}

Tensor multiply(const Tensor& y, const Tensor& x) {
  return broadcast(y, x, [](float a, float b) { return a * b; });
}

}  // namespace penumbra::nn::reference
