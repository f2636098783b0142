#include "nn/image/yuv422.h"

#include <algorithm>

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

ByteImage bgr_of_yuv422(const ByteView& pairs, Yuv422Order order) {
  ByteImage bgr(pairs.width, pairs.height, 3);
  const int luma = order == Yuv422Order::uyvy ? 1 : 0, chroma = 1 - luma;
  constexpr int kBits = 16, kHalf = 1 << (kBits - 1);  // of 1 in the factors below
  constexpr int kBrightness = 76309, kBlueU = 132201, kGreenU = 25675, kGreenV = 53279, kRedV = 104597;
  const auto level = [](int value) { return static_cast<std::uint8_t>(std::clamp(value >> kBits, 0, 255)); };
  for (int y = 0; y < pairs.height; ++y) {
    const std::uint8_t* in = pairs.row(y);
    std::uint8_t* out = bgr.row(y);
    for (int x = 0; x + 1 < pairs.width; x += 2, in += 4) {
      const int u = in[chroma] - 128, v = in[chroma + 2] - 128;
      for (const int pixel : {0, 1}) {
        const int bright = kBrightness * std::max(0, in[luma + 2 * pixel] - 16) + kHalf;
        *out++ = level(bright + kBlueU * u);
        *out++ = level(bright - kGreenU * u - kGreenV * v);
        *out++ = level(bright + kRedV * v);
      }
    }
  }
  return bgr;
}

}  // namespace penumbra
