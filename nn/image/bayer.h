// Colour of an image whose pixels saw one colour each, through a mosaic of filters.
//
// The two colours that a pixel did not see are means of the nearest pixels that did: of two or four, rounded
// to the nearest, halves up. Beyond the border the image is mirrored, so that the mosaic goes on. Cost: about
// 10 ns a pixel. Inside the border these are the bits of cv::cvtColor(COLOR_Bayer..2BGR), which names
// patterns by the second row. Source: B. E. Bayer, Color imaging array (US patent 3971065, 1976).
#pragma once

#include "nn/image/image.h"

namespace penumbra {

// The colours of the first two pixels of the first row, then of the second.
enum class BayerPattern { rggb, bggr, gbrg, grbg };

// Blue, green, red of 8 bits; `mosaic` has one channel and at least 2 x 2 pixels.
ByteImage demosaic(const ByteView& mosaic, BayerPattern pattern);

}  // namespace penumbra
