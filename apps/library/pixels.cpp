#include "apps/library/pixels.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "nn/base/error.h"
#include "nn/image/levels.h"

namespace penumbra {

namespace {

int bytes_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::grey8:
      return 1;
    case PixelFormat::depth16:
      return 2;
    case PixelFormat::depth32_metres:
      return 4;
    case PixelFormat::bgr8:
    case PixelFormat::rgb8:
      break;
  }
  return 3;
}

// Bytes from one row to the next.
std::ptrdiff_t checked_rows(const ImageRef& image, const Size& size, const char* place) {
  if (image.pixels == nullptr || image.width <= 0 || image.height <= 0)
    throw InputError(place, "an image", fmt::format("{} x {} pixels", image.width, image.height));
  if (size.width > 0 && (image.width != size.width || image.height != size.height)) {
    throw InputError(place, fmt::format("{} x {} pixels, as the rig says", size.width, size.height),
                     fmt::format("{} x {}", image.width, image.height));
  }
  const std::ptrdiff_t needed = std::ptrdiff_t(image.width) * bytes_of(image.format);
  if (image.row_bytes == 0) return needed;
  if (std::abs(image.row_bytes) < needed) {
    throw InputError(place, fmt::format("{} bytes a row or more", needed),
                     fmt::format("row_bytes {}", image.row_bytes));
  }
  return image.row_bytes;
}

template <class T>
Image<T> copy_rows(const ImageRef& image, int channels, std::ptrdiff_t row_bytes) {
  Image<T> copy(image.width, image.height, channels);
  const auto* from = static_cast<const std::byte*>(image.pixels);
  for (int y = 0; y < image.height; ++y)
    std::memcpy(copy.row(y), from + y * row_bytes, sizeof(T) * std::size_t(copy.pitch()));
  return copy;
}

}  // namespace

ByteImage byte_image_of(const ImageRef& image, const Size& size, const char* place) {
  if (image.format == PixelFormat::depth16 || image.format == PixelFormat::depth32_metres)
    throw InputError(place, "8-bit grey or colour", "depth");
  const std::ptrdiff_t row_bytes = checked_rows(image, size, place);
  ByteImage copy = copy_rows<std::uint8_t>(image, bytes_of(image.format), row_bytes);
  if (image.format == PixelFormat::rgb8) {
    std::uint8_t* pixel = copy.data();
    for (std::size_t i = 0; i < copy.elements(); i += 3) std::swap(pixel[i], pixel[i + 2]);
  }
  return copy;
}

WordImage depth_units_of(const ImageRef& image, const Size& size) {
  return copy_rows<std::uint16_t>(image, 1, checked_rows(image, size, "depth"));
}

FloatImage depth_metres_of(const ImageRef& image, const Size& size) {
  return known_metres(copy_rows<float>(image, 1, checked_rows(image, size, "depth")));
}

}  // namespace penumbra
