// JPEG files, with libjpeg (libjpeg-turbo on Debian).
#pragma once

#include <string>
#include <string_view>

#include "nn/image/image.h"

namespace penumbra::nn {

// The pixels of a JPEG that check_jpeg has passed, as grey (its luma) or BGR. Files of four inks (CMYK, YCCK)
// become what they print: R = C K / 255 with C, M, Y, K stored inverted, as Adobe's programs do. Throws
// InputError(place, ...) where they cannot be decoded; where the decoder had to guess, a warning on stderr
// names `place`.
ByteImage decode_jpeg(std::string_view bytes, bool grey, std::string_view place);

// `image` has 1 or 3 channels; `quality` 1..100, chroma at half the resolution.
std::string encode_jpeg(const ByteView& image, int quality = 95);

}  // namespace penumbra::nn
