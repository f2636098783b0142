#include "nn/layers/number_format.h"

#include <algorithm>
#include <cmath>

#include "nn/base/parallel.h"

namespace penumbra::nn {

Quantisation quantisation(const InputRange& range) {
  constexpr double kSteps = 255.0;
  const double low = std::min(range.low, 0.0), high = std::max(range.high, 0.0);
  Quantisation result;
  if (!(high > low)) return result;  // an input that was always 0
  result.scale = static_cast<float>((high - low) / kSteps);
  result.zero = static_cast<int>(std::lround(-low / (high - low) * kSteps));
  return result;
}

ArenaBuffer convert(const FeatureMap& map, const NumberFormat& format, Arena& arena) {
  constexpr std::ptrdiff_t kStep = 16 * 1024;  // values a task
  const int bytes = element_size(format.precision);
  const auto room =
      static_cast<std::size_t>(map.image_stride()) * static_cast<std::size_t>(map.batch().capacity);
  ArenaBuffer converted = arena.allocate(room * static_cast<std::size_t>(bytes) / sizeof(float));
  const std::ptrdiff_t count = map.images() * map.image_stride();
  auto* out = reinterpret_cast<std::byte*>(converted.data());
  parallel_pieces(count, kStep, [&](std::int64_t first, std::int64_t end, int) {
    low_precision_kernels(format.precision)
        .convert(map.values() + first, end - first, format.input, out + first * bytes);
  });
  return converted;
}

void observe(const FeatureMap& map, const NumberFormat& format) {
  if (format.observed == nullptr || map.images() == 0) return;
  float low = 0.0F, high = 0.0F;
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      const int lanes = std::min(map.block(),
                                 map.channels() - b * map.block());  // the others are not read
      for (int y = 0; y < map.height(); ++y) {
        const float* pixel = map.pixel(n, b, y, 0);
        for (int x = 0; x < map.width(); ++x, pixel += map.block()) {
          for (int c = 0; c < lanes; ++c) {
            low = std::min(low, pixel[c]);
            high = std::max(high, pixel[c]);
          }
        }
      }
    }
  }
  format.observed->add(low, high);
}

}  // namespace penumbra::nn
