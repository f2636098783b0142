#include "nn/image/yuv422.h"

namespace penumbra {

ByteImage grey_of_yuv422(const ByteView& pairs, Yuv422Order order) {
  ByteImage grey(pairs.width, pairs.height);
  const int first = order == Yuv422Order::uyvy ? 1 : 0;
  for (int y = 0; y < pairs.height; ++y) {
    const std::uint8_t* in = pairs.row(y) + first;
    std::uint8_t* out = grey.row(y);
    for (int x = 0; x < pairs.width; ++x) out[x] = in[2 * x];
  }
  return grey;
}

ByteImage bgr_of_yuv422(const ByteView& pairs, Yuv422Order order, const YuvRange& range) {
  ByteImage bgr(pairs.width, pairs.height, 3);
  const int luma = order == Yuv422Order::uyvy ? 1 : 0, chroma = 1 - luma;
  for (int y = 0; y < pairs.height; ++y) {
    const std::uint8_t* in = pairs.row(y);
    std::uint8_t* out = bgr.row(y);
    for (int x = 0; x + 1 < pairs.width; x += 2, in += 4) {
      for (const int pixel : {0, 1}) {
        put_bgr(range, in[luma + 2 * pixel], in[chroma], in[chroma + 2], out);
        out += 3;
      }
    }
  }
  return bgr;
}

}  // namespace penumbra
