// Image files, with errors that say what is wrong with them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "nn/image/image.h"
#include "nn/image/image_container.h"
#include "nn/image/png_codec.h"
#include "nn/image/stored_image.h"

namespace penumbra::nn {

// As the sensor's rows lie in the file, or turned as EXIF data say that the camera was held.
enum class ImageOrientation { sensor, upright };

// The formats that are read, for messages.
inline constexpr std::string_view kReadImages = "a PNG, JPEG, PGM or BMP image";

// Reads a PNG, JPEG, PGM, PPM or BMP, told by its first bytes, as 8-bit grey or BGR. 16-bit files are scaled
// down: of their significant bits (PNG: of all 16) the upper 8 stay. Throws InputError where the file is
// missing, is not such an image, or ends before its last row (a torn file is never returned half-filled).
ByteImage read_image(const std::filesystem::path& path, ImageColour colour,
                     ImageOrientation orientation = ImageOrientation::sensor);

// The same with all bits that the file has: 8 or 16 a channel, not scaled; the sensor's orientation.
StoredImage read_stored_image(const std::filesystem::path& path, ImageColour colour);

// All bits that the file has, or the upper 8 of its significant ones.
enum class ImageBits { stored, eight };
StoredImage read_image_bits(const std::filesystem::path& path, ImageColour colour, ImageBits bits);

// What the file says about itself, checked as above; its rows are not decoded.
ImageInfo read_image_info(const std::filesystem::path& path);

// The same of bytes that lie in another file; `place` names them. The pixels of a 16-bit grey image are what
// read_depth_image returns.
StoredImage decode_image(std::string bytes, ImageColour colour, ImageBits bits,
                         const std::filesystem::path& place);
ImageInfo image_info(std::string bytes, const std::filesystem::path& place);

// Reads a 16-bit grey PNG or PGM, such as a depth map, as it is. Throws InputError as above, and for any
// other image; `expected` says what it should have been.
WordImage read_depth_image(const std::filesystem::path& path,
                           std::string_view expected = "a 16-bit grey PNG (or PGM) with depth");

// The name's ending in small letters, with its dot.
std::string image_ending(const std::filesystem::path& path);

// Writes `image` (grey or BGR) in the format of the name's ending: .png, .jpg, .jpeg, .pgm or .ppm. Throws
// Error for another ending, and where the file cannot be written.
void write_image(const std::filesystem::path& path, const ByteView& image);

// 16 bits a channel: PNG only.
void write_image(const std::filesystem::path& path, const ImageView<const std::uint16_t>& image);

}  // namespace penumbra::nn
