// Naive pooling.
#include <algorithm>
#include <limits>

#include "nn/layers/reference/reference.h"

namespace penumbra::nn::reference {

namespace {

// Maximum, sum and number of the pixels of channel c in rows y0..y1-1 and columns x0..x1-1 inside the map.
struct Statistics {
  float top = -std::numeric_limits<float>::infinity();
  double sum = 0.0;
  int count = 0;
};

Statistics statistics(const Tensor& x, std::int64_t n, std::int64_t c, std::int64_t y0, std::int64_t y1,
                      std::int64_t x0, std::int64_t x1) {
  Statistics result;
  for (std::int64_t row = y0; row < y1; ++row) {
    for (std::int64_t column = x0; column < x1; ++column) {
      if (row < 0 || column < 0 || row >= x.extent(2) || column >= x.extent(3)) continue;
      result.top = std::max(result.top, x.at(n, c, row, column));
      result.sum += x.at(n, c, row, column);
      result.count += 1;
    }
  }
  return result;
}

// y[n, c, i, j] = value(n, c, i, j)
template <class Value>
Tensor fill(const Tensor& x, std::int64_t height, std::int64_t width, Value value) {
  Tensor y({x.extent(0), x.extent(1), height, width});
  for (std::int64_t n = 0; n < y.extent(0); ++n) {
    for (std::int64_t c = 0; c < y.extent(1); ++c) {
      for (std::int64_t i = 0; i < height; ++i) {
        for (std::int64_t j = 0; j < width; ++j) y.at(n, c, i, j) = static_cast<float>(value(n, c, i, j));
      }
    }
  }
  return y;
}

template <class Value>
Tensor window_pool(const Tensor& x, const PoolOptions& options, Value value) {
  const int k = options.kernel, s = options.stride, p = options.padding;
  return fill(x, (x.extent(2) + 2 * p - k) / s + 1, (x.extent(3) + 2 * p - k) / s + 1,
              [&](std::int64_t n, std::int64_t c, std::int64_t i, std::int64_t j) {
                return value(statistics(x, n, c, i * s - p, i * s - p + k, j * s - p, j * s - p + k));
              });
}

template <class Value>
Tensor adaptive_pool(const Tensor& x, std::int64_t height, std::int64_t width, Value value) {
  const auto first = [](std::int64_t i, std::int64_t in, std::int64_t out) { return i * in / out; };
  const auto end = [](std::int64_t i, std::int64_t in, std::int64_t out) {
    return ((i + 1) * in + out - 1) / out;
  };
  return fill(x, height, width, [&](std::int64_t n, std::int64_t c, std::int64_t i, std::int64_t j) {
    return value(statistics(x, n, c, first(i, x.extent(2), height), end(i, x.extent(2), height),
                            first(j, x.extent(3), width), end(j, x.extent(3), width)));
  });
}

}  // namespace

Tensor max_pool(const Tensor& x, const PoolOptions& options) {
  return window_pool(x, options, [](const Statistics& window) { return window.top; });
}

Tensor avg_pool(const Tensor& x, const PoolOptions& options, bool count_padding) {
  return window_pool(x, options, [&](const Statistics& window) {
    return window.sum / (count_padding ? options.kernel * options.kernel : window.count);
  });
}

Tensor adaptive_avg_pool(const Tensor& x, std::int64_t height, std::int64_t width) {
  return adaptive_pool(x, height, width, [](const Statistics& window) { return window.sum / window.count; });
}

Tensor adaptive_max_pool(const Tensor& x, std::int64_t height, std::int64_t width) {
  return adaptive_pool(x, height, width, [](const Statistics& window) { return window.top; });
}

Tensor global_avg_pool(const Tensor& x) {
  return fill(x, 1, 1, [&](std::int64_t n, std::int64_t c, std::int64_t, std::int64_t) {
    return statistics(x, n, c, 0, x.extent(2), 0, x.extent(3)).sum /
           static_cast<double>(x.extent(2) * x.extent(3));
  });
}

Tensor global_max_pool(const Tensor& x) {
  return fill(x, 1, 1, [&](std::int64_t n, std::int64_t c, std::int64_t, std::int64_t) {
    return statistics(x, n, c, 0, x.extent(2), 0, x.extent(3)).top;
  });
}

}  // namespace penumbra::nn::reference
