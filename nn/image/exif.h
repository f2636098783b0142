// How a camera was held, as its photograph's EXIF data say.
//
// EXIF data are a small TIFF file: the byte order ("II" little, "MM" big), the number 42, the place of a list
// of entries, and among the entries tag 0x0112, a whole number of 16 (by some writers 32) bits:
//
//   1 upright          2 mirrored left to right     3 turned by 180 degrees     4 mirrored top to bottom
//   5 transposed       6 to be turned 90 clockwise  7 transposed, turned 180    8 to be turned 90
//                                                                                 counterclockwise
//
// Source: CIPA DC-008 (Exif 2.32), sections 4.5 and 4.6.4 A; TIFF 6.0, section 2.
#pragma once

#include <string_view>

#include "nn/image/image.h"

namespace penumbra::nn {

inline constexpr int kUpright = 1;

// The orientation in EXIF data (a JPEG's APP1 segment or a PNG's eXIf chunk, with or without the prefix
// "Exif\0\0"). kUpright where they name none, or are damaged: pictures are read without them.
int exif_orientation(std::string_view exif);

// The picture as it is to be seen; itself for kUpright.
ByteImage turn_upright(const ByteImage& image, int orientation);

}  // namespace penumbra::nn
