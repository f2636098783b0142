// What an image file says about itself, checked before a decoder sees it: decoders fill what a torn file
// lacks with grey or black and only whisper about it on stderr.
//
// Sources: W3C Portable Network Graphics specification (3rd edition), sections 5 and 11; ITU-T T.81 (JPEG),
// annex B.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace penumbra::nn {

struct ImageInfo {
  int width = 0, height = 0;  // pixels as stored, both positive
  int bit_depth = 8;          // of a channel as stored: 1, 2, 4, 8 or 16
  // Of these the camera filled so many; bit_depth where the file does not say. By the PNG standard they are
  // the high ones, in PGM files (and in PNGs of many cameras, against the standard) the low ones.
  int significant_bits = 8;
  int orientation = 1;  // see exif.h
};

// More pixels than any camera has: a header that claims more is damaged or hostile.
constexpr long kMaxImagePixels = 1L << 27;

// The size alone; throws InputError(place, ...) where it is none or beyond kMaxImagePixels.
ImageInfo checked_image_size(std::uint64_t width, std::uint64_t height, std::string_view place);

bool looks_like_png(std::string_view bytes);
bool looks_like_jpeg(std::string_view bytes);

// Walks all chunks of a PNG and checks their lengths and CRCs, so that every file that lost or changed bytes
// is found. `bytes` is reduced to the chunks that hold pixels: the others (colour profiles, texts) do not
// change what we decode but make libpng print warnings. Significant bits are those of the chunk sBIT (the
// most of all channels), the orientation that of eXIf. Throws InputError(place, ...).
ImageInfo check_png(std::string& bytes, std::string_view place);

// Walks all markers of a JPEG up to its end-of-image marker, past which anything may follow. Throws
// InputError(place, ...), also where so few bytes cannot hold the claimed size. Bits that flipped inside the
// compressed rows are not found: JPEG has no checksum.
ImageInfo check_jpeg(std::string_view bytes, std::string_view place);

}  // namespace penumbra::nn
