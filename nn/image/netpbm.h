// PGM and PPM: a few words of text, then grey values or red, green and blue. Cameras' own tools and ROS write
// them.
//
//   P5 or P2 (grey), P6 or P3 (colour); width, height and the largest value, 1..65535, separated by spaces
//   and by comments from # to the line's end; one space; the rows. P5 and P6: bytes, or big-endian 16-bit
//   numbers where the largest value is above 255. P2 and P3: numbers as text.
//
// Source: Netpbm's manual pages pgm(5), ppm(5).
#pragma once

#include <string_view>

#include "nn/image/stored_image.h"

namespace penumbra::nn {

bool looks_like_netpbm(std::string_view bytes);

// Values of 8-bit files are scaled to 0..255; 16-bit ones stay as they are, their largest value is in
// info.significant_bits (1023: 10). Throws InputError(place, ...) where the file is not that, is torn, holds
// a value above the largest one, or goes on after its last row.
StoredImage read_netpbm(std::string_view bytes, std::string_view place);

}  // namespace penumbra::nn
