// Images in memory: rows of pixels, a pixel being 1 or more channels side by side.
//
//   element (x, y, c) = data[y * pitch + x * channels + c]        pitch in elements,
//                                                                at least width * channels
//
// `ImageView` looks at pixels that somebody else keeps: the whole of an image, a rectangle of it, a caller's
// buffer. `Image` keeps them. A copy of an Image shares its pixels, as a std::shared_ptr does; clone() does
// not. Colour is blue, green, red. Nothing here checks coordinates: who reads a file or an argument does.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace penumbra {

struct Size {
  int width = 0, height = 0;
  bool operator==(const Size&) const = default;
};

// The pixels x <= column < x + width, y <= row < y + height.
struct Rect {
  int x = 0, y = 0, width = 0, height = 0;

  bool operator==(const Rect&) const = default;
  bool empty() const { return width <= 0 || height <= 0; }
  int area() const { return width * height; }
  bool contains(int column, int row) const {
    return column >= x && column < x + width && row >= y && row < y + height;
  }
};

// The part that both have; empty where there is none.
inline Rect intersection(const Rect& a, const Rect& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  const Rect both{x, y, std::min(a.x + a.width, b.x + b.width) - x,
                  std::min(a.y + a.height, b.y + b.height) - y};
  return both.empty() ? Rect{} : both;
}

// The smallest that holds both; an empty one does not count.
inline Rect bounding(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y};
}

// `T` is const where the pixels are only read.
template <class T>
struct ImageView {
  T* data = nullptr;
  int width = 0, height = 0, channels = 1;
  std::ptrdiff_t pitch = 0;  // elements from a row to the next

  bool empty() const { return width == 0 || height == 0; }
  Size size() const { return {width, height}; }
  T* row(int y) const { return data + y * pitch; }
  T& at(int x, int y, int channel = 0) const { return row(y)[x * channels + channel]; }
  // Of a rectangle that lies inside.
  ImageView region(const Rect& r) const {
    return {row(r.y) + r.x * channels, r.width, r.height, channels, pitch};
  }
  operator ImageView<const T>() const requires(!std::is_const_v<T>) {
    return {data, width, height, channels, pitch};
  }
};

template <class T>
class Image {
 public:
  Image() = default;
  // The pixels are not set.
  Image(int width, int height, int channels = 1) { create(width, height, channels); }
  static Image filled(int width, int height, T value, int channels = 1) {
    Image image(width, height, channels);
    image.fill(value);
    return image;
  }
  // A copy of what a view shows.
  static Image copy_of(const ImageView<const T>& from) {
    Image image(from.width, from.height, from.channels);
    for (int y = 0; y < from.height; ++y)
      std::copy_n(from.row(y), std::size_t(from.width) * std::size_t(from.channels), image.row(y));
    return image;
  }

  // Makes it an image of this size, whose pixels are not set. Keeps the memory where it is large enough and
  // nobody shares it.
  void create(int width, int height, int channels = 1) {
    const std::size_t needed = std::size_t(width) * std::size_t(height) * std::size_t(channels);
    if (pixels_.use_count() != 1 || needed > capacity_) {
      pixels_ = std::shared_ptr<T[]>(new T[needed]);
      capacity_ = needed;
    }
    width_ = width;
    height_ = height;
    channels_ = channels;
  }
  Image clone() const { return copy_of(*this); }
  void fill(T value) { std::fill_n(pixels_.get(), elements(), value); }

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  Size size() const { return {width_, height_}; }
  bool empty() const { return width_ == 0 || height_ == 0; }
  // Pixels times channels; they lie without a gap.
  std::size_t elements() const { return std::size_t(width_) * std::size_t(height_) * std::size_t(channels_); }
  std::ptrdiff_t pitch() const { return std::ptrdiff_t(width_) * channels_; }

  T* data() { return pixels_.get(); }
  const T* data() const { return pixels_.get(); }
  T* row(int y) { return data() + y * pitch(); }
  const T* row(int y) const { return data() + y * pitch(); }
  T& at(int x, int y, int channel = 0) { return row(y)[x * channels_ + channel]; }
  const T& at(int x, int y, int channel = 0) const { return row(y)[x * channels_ + channel]; }

  ImageView<T> view() { return {data(), width_, height_, channels_, pitch()}; }
  ImageView<const T> view() const { return {data(), width_, height_, channels_, pitch()}; }
  ImageView<T> region(const Rect& r) { return view().region(r); }
  ImageView<const T> region(const Rect& r) const { return view().region(r); }
  operator ImageView<const T>() const { return view(); }
  operator ImageView<T>() { return view(); }

 private:
  std::shared_ptr<T[]> pixels_;
  std::size_t capacity_ = 0;  // elements
  int width_ = 0, height_ = 0, channels_ = 1;
};

using ByteImage = Image<std::uint8_t>;   // grey, or blue, green and red
using WordImage = Image<std::uint16_t>;  // depth as files keep it, or more than 8 bits
using FloatImage = Image<float>;         // depth in metres
using ByteView = ImageView<const std::uint8_t>;

}  // namespace penumbra
