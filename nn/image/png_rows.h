// The pixels of plain PNGs, without libpng: grey or colour of 8 bits and grey of 16, not interlaced, as
// cameras and datasets write them. Every row is packed with one of five filters, each of which tells a byte
// by its neighbours, bytes being compared with those of the pixel to the left (a), of the one above (b) and
// of the one left of that (c):
//
//   x = raw + 0,  a,  b,  (a + b) / 2,  Paeth: that of a, b, c which is nearest to a + b - c
//
// All of the stream is unpacked at once by libdeflate, the rows then one after the other. Cost: 1.5 ms at
// 1241 x 376, half of libpng's. Source: W3C Portable Network Graphics specification (3rd edition),
// sections 7 to 10.
#pragma once

#include <string_view>

#include "nn/image/stored_image.h"

namespace penumbra::nn {

enum class ImageColour { grey, bgr, stored };  // stored: as the file has it

// Fills `image`, whose info is known, with the pixels of a PNG that check_png has passed, colours as blue,
// green, red. False, and nothing is said of the pixels, where it is of another kind, or not of the one that
// is asked for (see decode_png), or damaged: libpng then decides.
bool decode_plain_png(std::string_view bytes, ImageColour colour, bool eight_bits, StoredImage& image);

}  // namespace penumbra::nn
