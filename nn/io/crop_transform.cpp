#include "nn/io/crop_transform.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "nn/base/error.h"
#include "nn/io/antialiased_resize.h"

namespace penumbra::nn {

FeatureMap transform_image(const ByteView& image, const CropTransform& transform, Arena& arena, int border) {
  if (image.empty() || (image.channels != 1 && image.channels != 3)) {
    throw InputError("image", "8-bit grey or BGR pixels",
                     fmt::format("{} x {} pixels of {} channels", image.width, image.height, image.channels));
  }
  const int shorter = std::min(image.width, image.height);
  const auto resized = [&](int extent) {
    return static_cast<int>(static_cast<std::int64_t>(transform.resize) * extent / shorter);
  };
  const Size size{resized(image.width), resized(image.height)};
  // Halves are rounded to even numbers, as Python's round does.
  const auto margin = [&](int extent) {
    return static_cast<int>(std::nearbyint((extent - transform.crop) / 2.0));
  };
  const Rect window{margin(size.width), margin(size.height), transform.crop, transform.crop};
  const ArenaVector<std::uint8_t> cropped = antialiased_resize(image, size, window, arena);

  FeatureMap map(arena, 1, 3, transform.crop, transform.crop, border, kImageBlock);
  const int channels = image.channels;
  const std::uint8_t* in = cropped.data();
  for (int y = 0; y < transform.crop; ++y) {
    float* out = map.pixel(0, 0, y, 0);
    for (int x = 0; x < transform.crop; ++x, in += channels, out += kImageBlock) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = static_cast<float>(in[channels == 3 ? 2 - c : 0]) / 255.0F;  // BGR to RGB
        out[c] = (value - transform.mean[c]) / transform.standard_deviation[c];
      }
      out[3] = 0.0F;
    }
  }
  return map;
}

}  // namespace penumbra::nn
