#include "nn/io/image_transform.h"

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "nn/base/linear_sample.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

ImageExtent transformed_extent(const ByteView& image, const ImageTransform& transform) {
  if (image.empty() || (image.channels != 1 && image.channels != 3)) {
    throw InputError("image", "8-bit grey or BGR pixels",
                     fmt::format("{} x {} pixels of {} channels", image.width, image.height, image.channels));
  }
  const int height = image.height, width = image.width;
  // PyTorch divides a number by a tensor as number * (1 / tensor), in f32: the last bit decides the floor
  // below.
  const auto ratio = [](int size, int extent) {
    return 1.0F / static_cast<float>(extent) * static_cast<float>(size);
  };
  const double scale = std::min(ratio(transform.min_size, std::min(height, width)),
                                ratio(transform.max_size, std::max(height, width)));
  ImageExtent result;
  // An extremely long image would lose its shorter side altogether.
  result.height = std::max(static_cast<int>(std::floor(height * scale)), 1);
  result.width = std::max(static_cast<int>(std::floor(width * scale)), 1);
  const auto padded = [&](int extent) {
    return (extent + transform.divisor - 1) / transform.divisor * transform.divisor;
  };
  result.padded_height = padded(result.height);
  result.padded_width = padded(result.width);
  return result;
}

FeatureMap transform_image(const ByteView& image, const ImageTransform& transform, Arena& arena, int border) {
  const ImageExtent result = transformed_extent(image, transform);
  const int height = image.height, width = image.width, channels = image.channels;
  FeatureMap map(arena, 1, 3, result.padded_height, result.padded_width, border, kImageBlock);

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
  parallel_for(map.height(), grain_of(4 * map.row_stride()), [&](int y) {
    float* out = map.pixel(0, 0, y, 0);
    if (y >= result.height) {
      std::fill_n(out, static_cast<std::ptrdiff_t>(map.width()) * kImageBlock, 0.0F);
      return;
    }
    const LinearSample row = linear_sample(half_pixel(y, scale_y), height);
    const std::uint8_t* upper = image.row(row.low);
    const std::uint8_t* lower = image.row(row.high);
    for (int x = 0; x < result.width; ++x, out += kImageBlock) {
      const LinearSample column = linear_sample(half_pixel(x, scale_x), width);
      const int left = column.low * channels, right = column.high * channels;
      const float fx = column.fraction, fy = row.fraction;
      for (int c = 0; c < 3; ++c) {
        const int byte = channels == 3 ? 2 - c : 0;  // BGR to RGB
        const auto& value = normalised[static_cast<std::size_t>(c)];
        const float top = (1.0F - fx) * value[upper[left + byte]] + fx * value[upper[right + byte]];
        const float bottom = (1.0F - fx) * value[lower[left + byte]] + fx * value[lower[right + byte]];
        out[c] = (1.0F - fy) * top + fy * bottom;
      }
      out[3] = 0.0F;
    }
    std::fill_n(out, static_cast<std::ptrdiff_t>(map.width() - result.width) * kImageBlock, 0.0F);
  });
  return map;
}

}  // namespace penumbra::nn
