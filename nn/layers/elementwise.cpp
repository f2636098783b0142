#include "nn/layers/elementwise.h"

#include "nn/base/error.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

template <class Operation>
void combine(const char* name, FeatureMap& y, const FeatureMap& x, Operation operation) {
  const auto fits = [](int extent, int whole) { return extent == whole || extent == 1; };
  if (!fits(x.images(), y.images()) || !fits(x.channels(), y.channels()) || !fits(x.height(), y.height()) ||
      !fits(x.width(), y.width()) || x.block() != kBlock || y.block() != kBlock) {
    throw InputError(name,
                     fmt::format("a map that broadcasts to [{}, {}, {}, {}]", y.images(), y.channels(),
                                 y.height(), y.width()),
                     fmt::format("[{}, {}, {}, {}]", x.images(), x.channels(), x.height(), x.width()));
  }
  const bool one_channel = x.channels() == 1 && y.channels() > 1;
  const std::ptrdiff_t step = x.width() == 1 ? 0 : kBlock;
  parallel_for({y.images(), y.blocks(), y.height()}, grain_of(y.row_stride()), [&](int n, int b, int i) {
    const float* from = x.pixel(x.images() == 1 ? 0 : n, one_channel ? 0 : b, x.height() == 1 ? 0 : i, 0);
    float* to = y.pixel(n, b, i, 0);
    for (int j = 0; j < y.width(); ++j, from += step, to += kBlock) {
      if (one_channel) {
        const float value = *from;
        for (int c = 0; c < kBlock; ++c) to[c] = operation(to[c], value);
      } else {
        for (int c = 0; c < kBlock; ++c) to[c] = operation(to[c], from[c]);
      }
    }
  });
}

}  // namespace

void add(FeatureMap& y, const FeatureMap& x) {
  combine("add", y, x, [](float a, float b) { return a + b; });
}

void multiply(FeatureMap& y, const FeatureMap& x) {
  combine("multiply", y, x, [](float a, float b) { return a * b; });
}

}  // namespace penumbra::nn
