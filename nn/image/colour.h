// Between grey and BGR.
#pragma once

#include <cstdint>

#include "nn/image/grey.h"
#include "nn/image/image.h"

namespace penumbra {

// blue = green = red = grey
template <class T>
Image<T> grey_to_bgr(const ImageView<const T>& grey) {
  Image<T> bgr(grey.width, grey.height, 3);
  for (int y = 0; y < grey.height; ++y) {
    const T* in = grey.row(y);
    T* out = bgr.row(y);
    for (int x = 0; x < grey.width; ++x) out[3 * x] = out[3 * x + 1] = out[3 * x + 2] = in[x];
  }
  return bgr;
}

// 16 bits a channel: grey = ( 1868 blue + 9617 green + 4899 red + 8192 ) / 16384, the bits of cv::cvtColor.
inline WordImage to_grey(const WordImage& image) {
  if (image.channels() == 1) return image;
  WordImage grey(image.width(), image.height());
  const std::uint16_t* in = image.data();
  for (std::size_t i = 0; i < grey.elements(); ++i, in += 3) {
    grey.data()[i] =
        static_cast<std::uint16_t>((1868U * in[0] + 9617U * in[1] + 4899U * in[2] + 8192U) >> 14);
  }
  return grey;
}

// The image with 1 or 3 channels; itself where it has them.
template <class T>
Image<T> with_channels(const Image<T>& image, int channels) {
  if (image.channels() == channels) return image;
  return channels == 1 ? to_grey(image) : grey_to_bgr(image.view());
}

}  // namespace penumbra
