#include "nn/io/antialiased_resize.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

constexpr int kWeightBits = 22;  // of a weight's fraction: 255 times the weights' sum fits into 32 bits

// The input pixels that one output pixel is made of.
struct Taps {
  int first, count;
  const std::int32_t* weights;
};

// Taps of the output pixels begin .. begin + count - 1 of `outputs`, from `inputs` input pixels.
class Filter {
 public:
  Filter(int inputs, int outputs, int begin, int count, Arena& arena) {
    const double scale = static_cast<double>(inputs) / outputs;
    const double support = std::max(scale, 1.0);
    const auto most_taps = static_cast<std::size_t>(2.0 * support) + 2;
    taps_ = ArenaVector<Taps>(arena, static_cast<std::size_t>(count));
    weights_ = ArenaVector<std::int32_t>(arena, static_cast<std::size_t>(count) * most_taps);
    ArenaVector<double> shares(arena, most_taps);
    for (int i = 0; i < count; ++i) {
      const double centre = (begin + i + 0.5) * scale;
      const int first = std::max(static_cast<int>(centre - support + 0.5), 0);
      const int last = std::min(static_cast<int>(centre + support + 0.5), inputs);
      shares.clear();
      double sum = 0.0;
      for (int j = first; j < last; ++j) {
        const double share = std::max(1.0 - std::abs((j - centre + 0.5) * (1.0 / support)), 0.0);
        shares.push_back(share);
        sum += share;
      }
      taps_.push_back({first, last - first, weights_.end()});
      for (const double share : shares) {
        weights_.push_back(static_cast<std::int32_t>(0.5 + share / sum * (1 << kWeightBits)));
      }
    }
  }

  const ArenaVector<Taps>& taps() const { return taps_; }
  // The input pixels that some output pixel reads.
  int first() const { return taps_[0].first; }
  int end() const { return taps_[taps_.size() - 1].first + taps_[taps_.size() - 1].count; }

 private:
  ArenaVector<Taps> taps_;
  ArenaVector<std::int32_t> weights_;
};

// One output value: `stride` bytes lie between input pixels.
std::uint8_t weighted_sum(const std::uint8_t* pixels, std::ptrdiff_t stride, const Taps& taps) {
  std::int32_t sum = 1 << (kWeightBits - 1);
  for (int j = 0; j < taps.count; ++j) {
    sum += *pixels * taps.weights[j];
    pixels += stride;
  }
  return static_cast<std::uint8_t>(std::clamp(sum >> kWeightBits, 0, 255));
}

}  // namespace

ArenaVector<std::uint8_t> antialiased_resize(const ByteView& image, const Size& size, const Rect& window,
                                             Arena& arena) {
  if (image.empty() || image.channels > 3) {
    throw InputError("image", "8-bit pixels of at most 3 channels",
                     fmt::format("{} x {} pixels of {} channels", image.width, image.height, image.channels));
  }
  if (window.empty() || intersection(window, {0, 0, size.width, size.height}) != window) {
    throw InputError("antialiased_resize", fmt::format("a window inside {} x {}", size.width, size.height),
                     fmt::format("{} x {} at ({}, {})", window.width, window.height, window.x, window.y));
  }
  // Buffers of the same size whatever the number of channels.
  constexpr std::size_t kMostChannels = 3;
  const auto bytes = [](int height, int width) {
    return static_cast<std::size_t>(height) * static_cast<std::size_t>(width) * kMostChannels;
  };
  ArenaVector<std::uint8_t> resized(arena, bytes(window.height, window.width));
  const Filter columns(image.width, size.width, window.x, window.width, arena);
  const Filter rows(image.height, size.height, window.y, window.height, arena);
  const int channels = image.channels, first_row = rows.first();

  ArenaVector<std::uint8_t> narrowed(arena, bytes(rows.end() - first_row, window.width));
  for (int y = first_row; y < rows.end(); ++y) {
    for (const Taps& taps : columns.taps()) {
      for (int c = 0; c < channels; ++c) {
        narrowed.push_back(weighted_sum(image.row(y) + taps.first * channels + c, channels, taps));
      }
    }
  }
  const std::ptrdiff_t row_bytes = static_cast<std::ptrdiff_t>(window.width) * channels;
  for (const Taps& taps : rows.taps()) {
    const std::uint8_t* in = narrowed.data() + (taps.first - first_row) * row_bytes;
    for (std::ptrdiff_t x = 0; x < row_bytes; ++x) resized.push_back(weighted_sum(in + x, row_bytes, taps));
  }
  return resized;
}

}  // namespace penumbra::nn
