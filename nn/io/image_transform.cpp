#include "nn/io/image_transform.h"

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"

namespace penumbra::nn {

TransformedImage transform_image(const cv::Mat& image, const ImageTransform& transform, Arena& arena,
                                 int border) {
  if (image.empty() || image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3)) {
    throw InputError("image", "8-bit grey or BGR pixels",
                     fmt::format("{} x {} pixels of {} channels", image.cols, image.rows, image.channels()));
  }
  const int height = image.rows, width = image.cols, channels = image.channels();
  const double scale =
      std::min(static_cast<float>(transform.min_size) / static_cast<float>(std::min(height, width)),
               static_cast<float>(transform.max_size) / static_cast<float>(std::max(height, width)));
  TransformedImage result;
  // An extremely long image would lose its shorter side altogether.
  result.height = std::max(static_cast<int>(std::floor(height * scale)), 1);
  result.width = std::max(static_cast<int>(std::floor(width * scale)), 1);
  const auto padded = [&](int extent) {
    return (extent + transform.divisor - 1) / transform.divisor * transform.divisor;
  };
  result.map = FeatureMap(arena, 1, 3, padded(result.height), padded(result.width), border, kImageBlock);

  // Red, green, blue of every byte value, normalised.
  std::array<std::array<float, 256>, 3> normalised;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t v = 0; v < 256; ++v) {
      normalised[c][v] =
          (static_cast<float>(v) / 255.0F - transform.mean[c]) / transform.standard_deviation[c];
    }
  }

  const float scale_y = static_cast<float>(height) / static_cast<float>(result.height);
  const float scale_x = static_cast<float>(width) / static_cast<float>(result.width);
  FeatureMap& map = result.map;
#pragma omp parallel for
  for (int y = 0; y < map.height(); ++y) {
    float* out = map.pixel(0, 0, y, 0);
    if (y >= result.height) {
      std::fill_n(out, static_cast<std::ptrdiff_t>(map.width()) * kImageBlock, 0.0F);
      continue;
    }
    const float source_y = std::max((static_cast<float>(y) + 0.5F) * scale_y - 0.5F, 0.0F);
    const int y0 = std::min(static_cast<int>(source_y), height - 1), y1 = std::min(y0 + 1, height - 1);
    const float fy = source_y - static_cast<float>(y0);
    const std::uint8_t* upper = image.ptr(y0);
    const std::uint8_t* lower = image.ptr(y1);
    for (int x = 0; x < result.width; ++x, out += kImageBlock) {
      const float source_x = std::max((static_cast<float>(x) + 0.5F) * scale_x - 0.5F, 0.0F);
      const int x0 = std::min(static_cast<int>(source_x), width - 1), x1 = std::min(x0 + 1, width - 1);
      const float fx = source_x - static_cast<float>(x0);
      for (int c = 0; c < 3; ++c) {
        const int byte = channels == 3 ? 2 - c : 0;  // BGR to RGB
        const auto& value = normalised[static_cast<std::size_t>(c)];
        const float top =
            (1.0F - fx) * value[upper[x0 * channels + byte]] + fx * value[upper[x1 * channels + byte]];
        const float bottom =
            (1.0F - fx) * value[lower[x0 * channels + byte]] + fx * value[lower[x1 * channels + byte]];
        out[c] = (1.0F - fy) * top + fy * bottom;
      }
      out[3] = 0.0F;
    }
    std::fill_n(out, static_cast<std::ptrdiff_t>(map.width() - result.width) * kImageBlock, 0.0F);
  }
  return result;
}

}  // namespace penumbra::nn
