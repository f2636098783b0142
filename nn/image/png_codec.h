// PNG files: plain ones as png_rows.h says, others with libpng.
#pragma once

#include <string>
#include <string_view>

#include "nn/image/image.h"
#include "nn/image/png_rows.h"
#include "nn/image/stored_image.h"

namespace penumbra::nn {

// The pixels of a PNG that check_png has passed: palettes and 1, 2 or 4 bits become 8 bits, transparency is
// left out. 16 bits stay, or, where `eight_bits` is set, of them the upper 8. Throws InputError(place, ...)
// where the compressed rows cannot be read.
StoredImage decode_png(std::string_view bytes, const ImageInfo& info, ImageColour colour, bool eight_bits,
                       std::string_view place);

// `image` has 1 or 3 channels. Rows are filtered by the difference to the pixel before and packed fast.
std::string encode_png(const ByteView& image);
std::string encode_png(const ImageView<const std::uint16_t>& image);

}  // namespace penumbra::nn
