// An image at another size. Pixel centres lie at whole coordinates plus a half of each image's pixel:
//
//   x = (u + 1/2) width / new_width - 1/2
//
// linear: between the 2 x 2 pixels around (x, y), those beyond the border being the outermost ones, 8 bits a
// channel, in fixed point (weights in 2048ths):
//
//   row = (left w0 + right w1) / 16,   out = ( row0 v0 / 65536 + row1 v1 / 65536 + 2 ) / 4,
//   each rounded down
//
// the bits of cv::resize(INTER_LINEAR). nearest: the pixel floor(u width / new_width), as
// cv::resize(INTER_NEAREST). area: the mean of what an output pixel covers, for making images smaller; it
// differs from cv::resize(INTER_AREA) by one level at most, where the sums of floats round differently.
#pragma once

#include <cmath>
#include <vector>

#include "nn/image/image.h"
#include "nn/image/linear_tap.h"
#include "nn/simd/image_kernels.h"

namespace penumbra {

// Keeps the weights of the last pair of sizes: for the images of a sequence.
// Cost from 1241 x 376 to 1034 x 313: 0.1 ms on one core.
class LinearResize {
 public:
  // `out` becomes an image of that size, above 0, with as many channels.
  void apply(const ByteView& in, const Size& size, ByteImage& out);

 private:
  void prepare(const ByteView& in, const Size& size);

  Size from_, to_;
  int channels_ = 0;
  std::vector<nn::ResizeBlock> blocks_;
  std::vector<std::int32_t> columns_;
  std::vector<std::int16_t> column_weights_;
  std::vector<LinearTap> rows_;
  std::vector<std::int16_t> stretched_[2];
};

ByteImage resize_linear(const ByteView& in, const Size& size);
ByteImage resize_area(const ByteView& in, const Size& size);

template <class T>
Image<T> resize_nearest(const ImageView<const T>& in, const Size& size) {
  Image<T> out(size.width, size.height, in.channels);
  const double step_x = linear_step(in.width, size.width);
  const double step_y = linear_step(in.height, size.height);
  std::vector<int> columns(static_cast<std::size_t>(size.width));
  for (int x = 0; x < size.width; ++x)
    columns[static_cast<std::size_t>(x)] = std::min(static_cast<int>(std::floor(x * step_x)), in.width - 1);
  for (int y = 0; y < size.height; ++y) {
    const T* from = in.row(std::min(static_cast<int>(std::floor(y * step_y)), in.height - 1));
    T* __restrict to = out.row(y);
    if (in.channels == 1) {
      for (int x = 0; x < size.width; ++x) to[x] = from[columns[static_cast<std::size_t>(x)]];
    } else {
      for (const int column : columns) to = std::copy_n(from + column * in.channels, in.channels, to);
    }
  }
  return out;
}

}  // namespace penumbra
