#include "nn/image/remap.h"

#include <cmath>
#include <limits>

#include "nn/simd/kernel_table.h"

namespace penumbra {

namespace {

constexpr float kFarAway = 2147483648.0F;  // places that no whole number holds are far left, or far up

int rounded(float x) {
  return std::abs(x) < kFarAway ? static_cast<int>(std::lrint(x)) : std::numeric_limits<int>::min();
}

// Along one axis of `length` pixels: the left one of two neighbours inside, and 32nds from it, 0..32.
struct Between {
  std::int16_t left;
  std::uint8_t share;
};
Between between(float x, int length) {
  constexpr int kBits = 5, kOne = 1 << kBits;
  const int fixed = rounded(x * kOne), whole = fixed >> kBits;
  if (whole < 0) return {0, 0};
  if (whole >= length - 1) return {static_cast<std::int16_t>(length - 2), kOne};
  return {static_cast<std::int16_t>(whole), static_cast<std::uint8_t>(fixed & (kOne - 1))};
}

}  // namespace

Remap::Remap(const FloatImage& x, const FloatImage& y, const Size& source)
    : size_(x.size()), source_(source) {
  const std::size_t count = x.elements();
  places_.resize(2 * count);
  dx_.resize(count);
  dy_.resize(count);
  nearest_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Between column = between(x.data()[i], source.width), row = between(y.data()[i], source.height);
    places_[2 * i] = column.left;
    places_[2 * i + 1] = row.left;
    dx_[i] = column.share;
    dy_[i] = row.share;
    const int u = rounded(x.data()[i]), v = rounded(y.data()[i]);
    const bool inside = u >= 0 && v >= 0 && u < source.width && v < source.height;
    nearest_[i] = inside ? v * source.width + u : -1;
  }
}

void Remap::linear(const ByteImage& image, ByteImage& out) const {
  if (is_identity()) {
    out = image;
    return;
  }
  out.create(size_.width, size_.height, image.channels());
  nn::RemapRowArguments a;
  a.image = image.data();
  a.pitch = image.pitch();
  a.channels = image.channels();
  a.width = size_.width;
  const auto remap_row = nn::kernels().image.remap_row;
  for (int y = 0; y < size_.height; ++y) {
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width);
    a.places = places_.data() + 2 * first;
    a.dx = dx_.data() + first;
    a.dy = dy_.data() + first;
    a.out = out.row(y);
    remap_row(a);
  }
}

template <class T>
void Remap::take_nearest(const Image<T>& image, Image<T>& out) const {
  if (is_identity()) {
    out = image;
    return;
  }
  out.create(size_.width, size_.height);
  T* to = out.data();
  for (const std::int32_t pixel : nearest_) *to++ = pixel < 0 ? T{0} : image.data()[pixel];
}

void Remap::nearest(const WordImage& image, WordImage& out) const { take_nearest(image, out); }
void Remap::nearest(const FloatImage& image, FloatImage& out) const { take_nearest(image, out); }

}  // namespace penumbra
