#include "nn/io/letterbox.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/image/linear_tap.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

namespace {

// Pixels of the frame before the image, of `frame` in all; the tenth decides where halves go.
int leading(int frame) { return static_cast<int>(std::lround(frame / 2.0 - 0.1)); }

}  // namespace

LetterboxFrame letterbox_frame(const ByteView& image, const Letterbox& letterbox) {
  if (image.empty() || (image.channels != 1 && image.channels != 3)) {
    throw InputError("image", "8-bit grey or BGR pixels",
                     fmt::format("{} x {} pixels of {} channels", image.width, image.height, image.channels));
  }
  const double scale = std::min(static_cast<double>(letterbox.size) / image.height,
                                static_cast<double>(letterbox.size) / image.width);
  const auto resized_extent = [&](int extent) {
    return std::max(static_cast<int>(std::nearbyint(extent * scale)), 1);
  };
  const auto padded = [&](int extent) {
    return (extent + letterbox.stride - 1) / letterbox.stride * letterbox.stride;
  };
  LetterboxFrame frame;
  frame.scale = static_cast<float>(scale);
  frame.width = resized_extent(image.width);
  frame.height = resized_extent(image.height);
  frame.map_width = padded(frame.width);
  frame.map_height = padded(frame.height);
  frame.left = leading(frame.map_width - frame.width);
  frame.top = leading(frame.map_height - frame.height);
  return frame;
}

FeatureMap letterbox_image(const ByteView& image, const Letterbox& letterbox, Arena& arena, int border) {
  const LetterboxFrame frame = letterbox_frame(image, letterbox);
  FeatureMap map(arena, 1, 3, frame.map_height, frame.map_width, border, kImageBlock);
  const int channels = image.channels;
  const double step_x = linear_step(image.width, frame.width);
  const double step_y = linear_step(image.height, frame.height);
  ArenaVector<LinearTap> columns(arena, static_cast<std::size_t>(frame.map_width));
  for (int x = 0; x < frame.width; ++x) columns.push_back(linear_tap(x, step_x, image.width));

  const float grey = static_cast<float>(letterbox.fill) / 255.0F;
  const auto fill = [grey](float* out, int pixels) {
    for (int x = 0; x < pixels; ++x, out += kImageBlock) {
      std::fill_n(out, 3, grey);
      out[3] = 0.0F;
    }
  };
  parallel_for(frame.map_height, grain_of(4 * map.row_stride()), [&](int y) {
    float* out = map.pixel(0, 0, y, 0);
    if (y < frame.top || y >= frame.top + frame.height) {
      fill(out, frame.map_width);
      return;
    }
    fill(out, frame.left);
    out += static_cast<std::ptrdiff_t>(frame.left) * kImageBlock;
    const LinearTap row = linear_tap(y - frame.top, step_y, image.height);
    const std::uint8_t* upper = image.row(row.low);
    const std::uint8_t* lower = image.row(row.high);
    for (const LinearTap& column : columns) {
      for (int c = 0; c < 3; ++c) {
        const int byte = channels == 3 ? 2 - c : 0;  // BGR to RGB
        const int left = column.low * channels + byte, right = column.high * channels + byte;
        const int top = upper[left] * column.low_weight + upper[right] * column.high_weight;
        const int bottom = lower[left] * column.low_weight + lower[right] * column.high_weight;
        const int sum = (row.low_weight * (top >> 4) >> 16) + (row.high_weight * (bottom >> 4) >> 16);
        out[c] = static_cast<float>((sum + 2) >> 2) / 255.0F;
      }
      out[3] = 0.0F;
      out += kImageBlock;
    }
    fill(out, frame.map_width - frame.left - frame.width);
  });
  return map;
}

}  // namespace penumbra::nn
