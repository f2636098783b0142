#include "nn/io/letterbox.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

// Pixels of the frame before the image, of `frame` in all; the tenth decides where halves go.
int leading(int frame) { return static_cast<int>(std::lround(frame / 2.0 - 0.1)); }

}  // namespace

LetterboxedImage letterbox_image(const cv::Mat& image, const Letterbox& letterbox, Arena& arena, int border) {
  if (image.empty() || image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3)) {
    throw InputError("image", "8-bit grey or BGR pixels",
                     fmt::format("{} x {} pixels of {} channels", image.cols, image.rows, image.channels()));
  }
  const double scale = std::min(static_cast<double>(letterbox.size) / image.rows,
                                static_cast<double>(letterbox.size) / image.cols);
  const auto resized_extent = [&](int extent) {
    return std::max(static_cast<int>(std::nearbyint(extent * scale)), 1);
  };
  const auto padded = [&](int extent) {
    return (extent + letterbox.stride - 1) / letterbox.stride * letterbox.stride;
  };
  LetterboxedImage result;
  result.scale = static_cast<float>(scale);
  result.width = resized_extent(image.cols);
  result.height = resized_extent(image.rows);
  const int map_width = padded(result.width), map_height = padded(result.height);
  result.left = leading(map_width - result.width);
  result.top = leading(map_height - result.height);
  result.map = FeatureMap(arena, 1, 3, map_height, map_width, border, kImageBlock);

  cv::Mat resized = image;
  if (image.size() != cv::Size(result.width, result.height)) {
    cv::resize(image, resized, {result.width, result.height}, 0, 0, cv::INTER_LINEAR);
  }
  const int channels = resized.channels();
  const float grey = static_cast<float>(letterbox.fill) / 255.0F;
  const auto fill = [grey](float* out, int pixels) {
    for (int x = 0; x < pixels; ++x, out += kImageBlock) {
      std::fill_n(out, 3, grey);
      out[3] = 0.0F;
    }
  };
#pragma omp parallel for
  for (int y = 0; y < map_height; ++y) {
    float* out = result.map.pixel(0, 0, y, 0);
    const int row = y - result.top;
    if (row < 0 || row >= result.height) {
      fill(out, map_width);
      continue;
    }
    fill(out, result.left);
    out += static_cast<std::ptrdiff_t>(result.left) * kImageBlock;
    const std::uint8_t* in = resized.ptr(row);
    for (int x = 0; x < result.width; ++x, in += channels, out += kImageBlock) {
      for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(in[channels == 3 ? 2 - c : 0]) / 255.0F;
      out[3] = 0.0F;
    }
    fill(out, map_width - result.left - result.width);
  }
  return result;
}

}  // namespace penumbra::nn
