#include "nn/image/image_file.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"
#include "nn/image/bmp.h"
#include "nn/image/colour.h"
#include "nn/image/exif.h"
#include "nn/image/foreign_image.h"
#include "nn/image/image_container.h"
#include "nn/image/jpeg_codec.h"
#include "nn/image/levels.h"
#include "nn/image/netpbm.h"

namespace penumbra::nn {

namespace {

std::string read_image_bytes(const std::filesystem::path& path, std::string_view expected) {
  std::string bytes = read_file(path, expected);
  if (bytes.empty()) throw InputError(path.string(), expected, "an empty file");
  return bytes;
}

// An image of the formats whose rows are read here.
StoredImage read_plain_rows(const std::string& bytes, const std::filesystem::path& path,
                            std::string_view expected) {
  const std::string place = path.string();
  if (looks_like_netpbm(bytes)) return read_netpbm(bytes, place);
  if (looks_like_bmp(bytes)) return read_bmp(bytes, place);
  throw InputError(place, expected, describe_foreign_image(bytes, path));
}

StoredImage decode(std::string bytes, ImageColour colour, bool eight_bits, const std::filesystem::path& path,
                   std::string_view expected) {
  const std::string place = path.string();
  if (looks_like_png(bytes)) {
    const ImageInfo info = check_png(bytes, place);
    return decode_png(bytes, info, colour, eight_bits, place);
  }
  StoredImage image;
  if (looks_like_jpeg(bytes)) {
    image.info = check_jpeg(bytes, place);
    image.bytes = decode_jpeg(bytes, colour == ImageColour::grey, place);
    if (image.size() != Size{image.info.width, image.info.height}) {
      throw InputError(place,
                       fmt::format("{} x {} pixels, as the header says", image.info.width, image.info.height),
                       fmt::format("{} x {}", image.size().width, image.size().height));
    }
    return image;
  }
  image = read_plain_rows(bytes, path, expected);
  if (eight_bits && image.is_wide()) {
    image.bytes = upper_bits(image.words, image.info.significant_bits);
    image.words = {};
  }
  if (colour != ImageColour::stored) {
    const int channels = colour == ImageColour::grey ? 1 : 3;
    if (image.is_wide()) {
      image.words = with_channels(image.words, channels);
    } else {
      image.bytes = with_channels(image.bytes, channels);
    }
  }
  return image;
}

StoredImage decode_file(const std::filesystem::path& path, ImageColour colour, bool eight_bits,
                        std::string_view expected) {
  return decode(read_image_bytes(path, expected), colour, eight_bits, path, expected);
}

// PGM or PPM, whose colours are red, green, blue.
std::string encode_netpbm(const ByteView& image) {
  std::string bytes =
      fmt::format("{}\n{} {}\n255\n", image.channels == 1 ? "P5" : "P6", image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = image.channels - 1; c >= 0; --c) bytes += static_cast<char>(image.at(x, y, c));
    }
  }
  return bytes;
}

}  // namespace

std::string image_ending(const std::filesystem::path& path) { return lower_case(path.extension().string()); }

ByteImage read_image(const std::filesystem::path& path, ImageColour colour, ImageOrientation orientation) {
  const StoredImage image = decode_file(path, colour, /*eight_bits=*/true, kReadImages);
  return orientation == ImageOrientation::upright ? turn_upright(image.bytes, image.info.orientation)
                                                  : image.bytes;
}

StoredImage read_stored_image(const std::filesystem::path& path, ImageColour colour) {
  return decode_file(path, colour, /*eight_bits=*/false, kReadImages);
}

StoredImage read_image_bits(const std::filesystem::path& path, ImageColour colour, ImageBits bits) {
  return decode_file(path, colour, bits == ImageBits::eight, kReadImages);
}

ImageInfo read_image_info(const std::filesystem::path& path) {
  return image_info(read_image_bytes(path, kReadImages), path);
}

StoredImage decode_image(std::string bytes, ImageColour colour, ImageBits bits,
                         const std::filesystem::path& place) {
  return decode(std::move(bytes), colour, bits == ImageBits::eight, place, kReadImages);
}

ImageInfo image_info(std::string bytes, const std::filesystem::path& path) {
  const std::string place = path.string();
  if (looks_like_png(bytes)) return check_png(bytes, place);
  if (looks_like_jpeg(bytes)) return check_jpeg(bytes, place);
  return read_plain_rows(bytes, path, kReadImages).info;
}

WordImage read_depth_image(const std::filesystem::path& path, std::string_view expected) {
  const StoredImage image = decode_file(path, ImageColour::stored, /*eight_bits=*/false, expected);
  if (!image.is_wide() || image.channels() != 1) {
    throw InputError(
        path.string(), expected,
        fmt::format("{} of {} bits", counted(image.channels(), "channel"), image.is_wide() ? 16 : 8));
  }
  return image.words;
}

void write_image(const std::filesystem::path& path, const ByteView& image) {
  if (image.empty()) throw Error(fmt::format("{}: cannot encode the image: it is empty", path.string()));
  const std::string ending = image_ending(path);
  std::string bytes;
  if (ending == ".png") {
    bytes = encode_png(image);
  } else if (ending == ".jpg" || ending == ".jpeg") {
    bytes = encode_jpeg(image);
  } else if ((ending == ".pgm" && image.channels == 1) || (ending == ".ppm" && image.channels == 3)) {
    bytes = encode_netpbm(image);
  } else {
    throw Error(fmt::format(
        "{}: cannot encode the image: expected a name that ends with .png, .jpg or {}, found '{}'",
        path.string(), image.channels == 1 ? ".pgm" : ".ppm", ending));
  }
  write_file(path, bytes, /*durable=*/false);
}

void write_image(const std::filesystem::path& path, const ImageView<const std::uint16_t>& image) {
  if (image_ending(path) != ".png")
    throw Error(fmt::format("{}: cannot encode 16-bit pixels but in a .png", path.string()));
  write_file(path, encode_png(image), /*durable=*/false);
}

}  // namespace penumbra::nn
