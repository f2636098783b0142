// Moves an image's pixels as a table of places says, which is made once for many images.
//
//   out(u, v) = in(x(u, v), y(u, v))
//
// linear: places are rounded to 32nds of a pixel, then
//
//   out = ( (p00 (32 - a) + p01 a) (32 - b) + (p10 (32 - a) + p11 a) b + 512 ) / 1024
//
// Beyond the border lie the outermost pixels. nearest: the pixel at the rounded place (halves to the even
// one), 0 beyond the border; for what must not be mixed, such as depth. Both give the bits of cv::convertMaps
// to CV_16SC2 and cv::remap with BORDER_REPLICATE and BORDER_CONSTANT.
// Cost at 752 x 480, grey: 0.4 ms on one core. Memory: 10 bytes a pixel.
#pragma once

#include <vector>

#include "nn/image/image.h"

namespace penumbra {

class Remap {
 public:
  Remap() = default;  // leaves images as they are
  // `x`, `y`: of the result's size. The images to be moved have the size `source`, 2 x 2 to 32767 x 32767.
  Remap(const FloatImage& x, const FloatImage& y, const Size& source);

  bool is_identity() const { return places_.empty(); }
  // `image`: 8 bits, 1 or 3 channels. `out` keeps its memory where it can.
  void linear(const ByteImage& image, ByteImage& out) const;
  void nearest(const WordImage& image, WordImage& out) const;    // 1 channel
  void nearest(const FloatImage& image, FloatImage& out) const;  // likewise
  ByteImage linear(const ByteImage& image) const {
    ByteImage out;
    linear(image, out);
    return out;
  }
  template <class T>
  Image<T> nearest(const Image<T>& image) const {
    Image<T> out;
    nearest(image, out);
    return out;
  }

 private:
  template <class T>
  void take_nearest(const Image<T>& image, Image<T>& out) const;

  Size size_, source_;
  std::vector<std::int16_t> places_;   // columns and rows of the upper left one of four pixels
  std::vector<std::uint8_t> dx_, dy_;  // 32nds
  std::vector<std::int32_t> nearest_;  // pixels by number; -1: outside
};

}  // namespace penumbra
