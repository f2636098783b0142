// BMP without compression: 1, 4 or 8 bits a pixel with a table of colours, 24 or 32 bits of blue, green, red.
//
//   bytes 0..13    "BM", file size, 4 unused bytes, where the rows begin
//   14..           the header: its own size (40 or more), width, height (negative: the top row comes first),
//                  planes, bits a pixel, compression (0), ..., colours in the table (byte 32 of the header)
//   then           the table: blue, green, red, unused; 2^bits entries or as many as said
//   the rows       bottom row first, each padded to a multiple of 4 bytes
//
// All numbers are little-endian. Source: Microsoft, BITMAPFILEHEADER and BITMAPINFOHEADER.
#pragma once

#include <string_view>

#include "nn/image/stored_image.h"

namespace penumbra::nn {

bool looks_like_bmp(std::string_view bytes);

// Grey where the table holds only greys, else BGR; the fourth byte of 32-bit pixels is left out. Throws
// InputError(place, ...) for what is torn or of another kind.
StoredImage read_bmp(std::string_view bytes, std::string_view place);

}  // namespace penumbra::nn
