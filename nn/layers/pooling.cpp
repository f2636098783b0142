#include "nn/layers/pooling.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

namespace {

// Pixels first..end-1 of an axis that a window covers, and the divisor that its mean has along that axis.
struct Window {
  int first, end, divisor;
};

struct Maximum {
  static void reduce(const FeatureMap& input, int n, int b, const Window& rows, const Window& columns,
                     float* out) {
    float best[kBlock];
    std::memcpy(best, input.pixel(n, b, rows.first, columns.first), sizeof(best));
    for (int y = rows.first; y < rows.end; ++y) {
      const float* in = input.pixel(n, b, y, columns.first);
      for (int x = columns.first; x < columns.end; ++x, in += kBlock) {
        for (int c = 0; c < kBlock; ++c) best[c] = std::max(best[c], in[c]);
      }
    }
    std::memcpy(out, best, sizeof(best));
  }
  static void reduce_narrow(const FeatureMap& input, int n, int b, const Window& rows, const Window& columns,
                            std::byte* out) {
    const Precision precision = input.numbers().precision;
    line_kernels()->max_line({input.line(n, b, rows.first, columns.first),
                              input.row_stride() * element_size(precision), rows.end - rows.first,
                              columns.end - columns.first, precision, out});
  }
};

struct Mean {
  static void reduce(const FeatureMap& input, int n, int b, const Window& rows, const Window& columns,
                     float* out) {
    float sum[kBlock] = {};
    for (int y = rows.first; y < rows.end; ++y) {
      float row_sum[kBlock] = {};
      const float* in = input.pixel(n, b, y, columns.first);
      for (int x = columns.first; x < columns.end; ++x, in += kBlock) {
        for (int c = 0; c < kBlock; ++c) row_sum[c] += in[c];
      }
      for (int c = 0; c < kBlock; ++c) sum[c] += row_sum[c];
    }
    const auto divisor = static_cast<float>(rows.divisor) * static_cast<float>(columns.divisor);
    for (int c = 0; c < kBlock; ++c) out[c] = sum[c] / divisor;
  }
};

// One Reduction a pixel of the output; rows(i) and columns(j) give its window.
template <class Reduction, class Rows, class Columns>
FeatureMap pool(const FeatureMap& input, int height, int width, Arena& arena, int output_border, Rows rows,
                Columns columns) {
  const bool narrow = input.numbers().precision != Precision::f32;
  if (narrow && std::is_same_v<Reduction, Mean>)
    throw InputError("mean over pixels", "a map in f32", "another");
  FeatureMap output(arena, input.batch(), input.channels(), height, width, output_border, input.numbers());
  const std::int64_t window_values = std::int64_t{ceil_div(input.height(), height)} * input.row_stride();
  parallel_for({output.images(), output.blocks(), height}, grain_of(window_values), [&](int n, int b, int i) {
    const Window window = rows(i);
    for (int j = 0; j < width; ++j) {
      if constexpr (std::is_same_v<Reduction, Maximum>) {
        if (narrow) {
          Maximum::reduce_narrow(input, n, b, window, columns(j), output.line(n, b, i, j));
          continue;
        }
      }
      Reduction::reduce(input, n, b, window, columns(j), output.pixel(n, b, i, j));
    }
  });
  return output;
}

template <class Reduction>
FeatureMap window_pool(const char* name, const FeatureMap& input, PoolOptions options, bool count_padding,
                       Arena& arena, int output_border) {
  const auto [kernel, stride, padding] = options;
  if (kernel < 1 || stride < 1 || padding < 0 || padding > kernel / 2) {
    throw InputError(name, "kernel and stride >= 1, 0 <= padding <= kernel / 2",
                     fmt::format("kernel {}, stride {}, padding {}", kernel, stride, padding));
  }
  const int height = (input.height() + 2 * padding - kernel) / stride + 1;
  const int width = (input.width() + 2 * padding - kernel) / stride + 1;
  if (input.height() + 2 * padding < kernel || input.width() + 2 * padding < kernel) {
    throw InputError(name, fmt::format("an input that covers the {0} x {0} window", kernel),
                     fmt::format("{} x {} with padding {}", input.height(), input.width(), padding));
  }
  const auto window = [=, kernel = kernel, stride = stride, padding = padding](int i, int extent) {
    const int first = std::max(i * stride - padding, 0),
              end = std::min(i * stride - padding + kernel, extent);
    return Window{first, end, count_padding ? kernel : end - first};
  };
  return pool<Reduction>(
      input, height, width, arena, output_border, [&](int i) { return window(i, input.height()); },
      [&](int j) { return window(j, input.width()); });
}

// Windows that share an axis as evenly as whole pixels allow.
template <class Reduction>
FeatureMap adaptive_pool(const char* name, const FeatureMap& input, int height, int width, Arena& arena,
                         int output_border) {
  if (height < 1 || width < 1 || input.height() < 1 || input.width() < 1) {
    throw InputError(name, "at least one pixel in and out",
                     fmt::format("{} x {} to {} x {}", input.height(), input.width(), height, width));
  }
  const auto window = [](int i, int extent, int parts) {
    const int first = i * extent / parts, end = ((i + 1) * extent + parts - 1) / parts;
    return Window{first, end, end - first};
  };
  return pool<Reduction>(
      input, height, width, arena, output_border, [&](int i) { return window(i, input.height(), height); },
      [&](int j) { return window(j, input.width(), width); });
}

}  // namespace

FeatureMap max_pool(const FeatureMap& input, PoolOptions options, Arena& arena, int output_border) {
  return window_pool<Maximum>("max_pool", input, options, false, arena, output_border);
}

FeatureMap avg_pool(const FeatureMap& input, PoolOptions options, bool count_padding, Arena& arena,
                    int output_border) {
  return window_pool<Mean>("avg_pool", input, options, count_padding, arena, output_border);
}

FeatureMap adaptive_avg_pool(const FeatureMap& input, int height, int width, Arena& arena,
                             int output_border) {
  return adaptive_pool<Mean>("adaptive_avg_pool", input, height, width, arena, output_border);
}

FeatureMap adaptive_max_pool(const FeatureMap& input, int height, int width, Arena& arena,
                             int output_border) {
  return adaptive_pool<Maximum>("adaptive_max_pool", input, height, width, arena, output_border);
}

FeatureMap global_avg_pool(const FeatureMap& input, Arena& arena, int output_border) {
  return adaptive_pool<Mean>("global_avg_pool", input, 1, 1, arena, output_border);
}

FeatureMap global_max_pool(const FeatureMap& input, Arena& arena, int output_border) {
  return adaptive_pool<Maximum>("global_max_pool", input, 1, 1, arena, output_border);
}

}  // namespace penumbra::nn
