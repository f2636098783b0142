// What an image file says about itself, checked before a decoder sees it: decoders fill what a torn file
// lacks with grey or black and only whisper about it on stderr.
//
// Sources: W3C Portable Network Graphics specification (2nd edition), sections 5 and 11; ITU-T T.81 (JPEG),
// annex B.
#pragma once

#include <string>
#include <string_view>

namespace penumbra::nn {

struct ImageSize {
  int width = 0, height = 0;  // pixels, both positive
};

// More pixels than any camera has: a header that claims more is damaged or hostile.
constexpr long kMaxImagePixels = 1L << 27;

bool looks_like_png(std::string_view bytes);
bool looks_like_jpeg(std::string_view bytes);

// Walks all chunks of a PNG and checks their lengths and CRCs, so that every file that lost or changed bytes
// is found. `bytes` is reduced to the chunks that hold pixels: the others (colour profiles, texts) do not
// change what we decode but make libpng print warnings. Throws InputError(place, ...).
ImageSize check_png(std::string& bytes, std::string_view place);

// Walks all markers of a JPEG up to its end-of-image marker, past which anything may follow. Throws
// InputError(place, ...), also where so few bytes cannot hold the claimed size. Bits that flipped inside the
// compressed rows are not found: JPEG has no checksum.
ImageSize check_jpeg(std::string_view bytes, std::string_view place);

}  // namespace penumbra::nn
