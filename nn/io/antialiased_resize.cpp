#include "nn/io/antialiased_resize.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

constexpr int kWeightBits = 22;  // of a weight's fraction: 255 times the weights' sum fits into 32 bits

// The input pixels that one output pixel is made of.
struct Taps {
  int first = 0;
  std::vector<std::int32_t> weights;
};

// Taps of the output pixels begin .. begin + count - 1 of `outputs`, from `inputs` input pixels.
std::vector<Taps> filter_taps(int inputs, int outputs, int begin, int count) {
  const double scale = static_cast<double>(inputs) / outputs;
  const double support = std::max(scale, 1.0);
  std::vector<Taps> taps(static_cast<std::size_t>(count));
  std::vector<double> weights;
  for (int i = 0; i < count; ++i) {
    const double centre = (begin + i + 0.5) * scale;
    const int first = std::max(static_cast<int>(centre - support + 0.5), 0);
    const int last = std::min(static_cast<int>(centre + support + 0.5), inputs);
    weights.clear();
    double sum = 0.0;
    for (int j = first; j < last; ++j) {
      weights.push_back(std::max(1.0 - std::abs((j - centre + 0.5) * (1.0 / support)), 0.0));
      sum += weights.back();
    }
    Taps& tap = taps[static_cast<std::size_t>(i)];
    tap.first = first;
    for (const double weight : weights) {
      tap.weights.push_back(static_cast<std::int32_t>(0.5 + weight / sum * (1 << kWeightBits)));
    }
  }
  return taps;
}

// One output value: `stride` bytes lie between input pixels.
std::uint8_t weighted_sum(const std::uint8_t* pixels, std::ptrdiff_t stride, const Taps& taps) {
  std::int32_t sum = 1 << (kWeightBits - 1);
  for (const std::int32_t weight : taps.weights) {
    sum += *pixels * weight;
    pixels += stride;
  }
  return static_cast<std::uint8_t>(std::clamp(sum >> kWeightBits, 0, 255));
}

}  // namespace

cv::Mat antialiased_resize(const cv::Mat& image, const cv::Size& size, const cv::Rect& window) {
  if (image.empty() || image.depth() != CV_8U) {
    throw InputError("image", "8-bit pixels",
                     fmt::format("{} x {} pixels of depth {}", image.cols, image.rows, image.depth()));
  }
  if (window.empty() || (window & cv::Rect({}, size)) != window) {
    throw InputError("antialiased_resize", fmt::format("a window inside {} x {}", size.width, size.height),
                     fmt::format("{} x {} at ({}, {})", window.width, window.height, window.x, window.y));
  }
  const std::vector<Taps> columns = filter_taps(image.cols, size.width, window.x, window.width);
  const std::vector<Taps> rows = filter_taps(image.rows, size.height, window.y, window.height);
  const int channels = image.channels();

  // Only the input rows that some output row reads.
  const int first_row = rows.front().first;
  const int last_row = rows.back().first + static_cast<int>(rows.back().weights.size());
  cv::Mat narrowed(last_row - first_row, window.width, image.type());
  for (int y = 0; y < narrowed.rows; ++y) {
    const std::uint8_t* in = image.ptr(first_row + y);
    std::uint8_t* out = narrowed.ptr(y);
    for (const Taps& taps : columns) {
      for (int c = 0; c < channels; ++c)
        *out++ = weighted_sum(in + taps.first * channels + c, channels, taps);
    }
  }
  cv::Mat resized(window.height, window.width, image.type());
  const auto row_stride = static_cast<std::ptrdiff_t>(narrowed.step);
  for (int y = 0; y < resized.rows; ++y) {
    const Taps& taps = rows[static_cast<std::size_t>(y)];
    const std::uint8_t* in = narrowed.ptr(taps.first - first_row);
    std::uint8_t* out = resized.ptr(y);
    for (int x = 0; x < resized.cols * channels; ++x) out[x] = weighted_sum(in + x, row_stride, taps);
  }
  return resized;
}

}  // namespace penumbra::nn
