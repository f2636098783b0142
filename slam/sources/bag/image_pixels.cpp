#include "slam/sources/bag/image_pixels.h"

#include <algorithm>
#include <cstring>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/image/levels.h"
#include "nn/image/yuv422.h"
#include "slam/sources/bag/pixel_encoding.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// The image's rows, checked against the message.
struct Rows {
  const PixelEncoding* encoding;
  int width, height;
  std::size_t step;
  const std::uint8_t* data;

  Rows(const ImageMessage& image, const std::string& place) : encoding(find_encoding(image.encoding)) {
    if (encoding == nullptr) {
      throw InputError(place,
                       "an image in mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_*8, yuv422, yuv422_yuy2, "
                       "16UC1 or 32FC1",
                       fmt::format("the encoding '{}'", printable(image.encoding, 40)));
    }
    const nn::ImageInfo size = nn::checked_image_size(image.width, image.height, place);
    width = size.width;
    height = size.height;
    step = image.step;
    data = reinterpret_cast<const std::uint8_t*>(image.data.data());
    const std::size_t row = static_cast<std::size_t>(width) * encoding->bytes;
    const std::size_t needed = step * (static_cast<std::size_t>(height) - 1) + row;
    if (step < row)
      throw InputError(place, fmt::format("rows of at least {} bytes", row), fmt::format("{}", step));
    if (image.data.size() < needed)
      throw InputError(place, fmt::format("{} bytes of pixels", needed),
                       fmt::format("{}", image.data.size()));
  }

  ByteView bytes(int channels) const {
    return {data, width, height, channels, static_cast<std::ptrdiff_t>(step)};
  }
  const std::uint8_t* row(int y) const { return data + static_cast<std::size_t>(y) * step; }
};

// Of 4 bytes a pixel at most, in any byte order.
template <class T>
Image<T> numbers_of(const Rows& rows, bool is_big_endian) {
  Image<T> image(rows.width, rows.height);
  for (int y = 0; y < rows.height; ++y) {
    std::memcpy(image.row(y), rows.row(y), sizeof(T) * static_cast<std::size_t>(rows.width));
    if (!is_big_endian) continue;
    auto* bytes = reinterpret_cast<unsigned char*>(image.row(y));
    for (int x = 0; x < rows.width; ++x, bytes += sizeof(T)) std::reverse(bytes, bytes + sizeof(T));
  }
  return image;
}

// Pixels of 3 or 4 bytes of which `red` says where red stands, as blue, green, red.
ByteImage bgr_of(const Rows& rows, int bytes, int red) {
  ByteImage bgr(rows.width, rows.height, 3);
  for (int y = 0; y < rows.height; ++y) {
    const std::uint8_t* in = rows.row(y);
    std::uint8_t* out = bgr.row(y);
    for (int x = 0; x < rows.width; ++x, in += bytes, out += 3) {
      out[0] = in[2 - red];
      out[1] = in[1];
      out[2] = in[red];
    }
  }
  return bgr;
}

ByteImage yuv_of(const Rows& rows, bool is_grey, const std::string& place) {
  if (rows.width % 2 != 0)
    throw InputError(place, "an even width of yuv422 images", fmt::format("{}", rows.width));
  const Yuv422Order order =
      rows.encoding->layout == PixelLayout::uyvy ? Yuv422Order::uyvy : Yuv422Order::yuyv;
  return is_grey ? grey_of_yuv422(rows.bytes(2), order) : bgr_of_yuv422(rows.bytes(2), order);
}

}  // namespace

nn::StoredImage pixels_of(const ImageMessage& image, nn::ImageColour colour, nn::ImageBits bits,
                          const fs::path& path) {
  const std::string place = path.string();
  const Rows rows(image, place);
  nn::StoredImage result;
  result.info = info_of(image, path);
  switch (rows.encoding->layout) {
    case PixelLayout::grey8:
      result.bytes = ByteImage::copy_of(rows.bytes(1));
      break;
    case PixelLayout::grey16:
      result.words = numbers_of<std::uint16_t>(rows, image.is_big_endian);
      break;
    case PixelLayout::rgb:
      result.bytes = bgr_of(rows, 3, 0);
      break;
    case PixelLayout::bgr:
      result.bytes = bgr_of(rows, 3, 2);
      break;
    case PixelLayout::rgba:
      result.bytes = bgr_of(rows, 4, 0);
      break;
    case PixelLayout::bgra:
      result.bytes = bgr_of(rows, 4, 2);
      break;
    case PixelLayout::uyvy:
    case PixelLayout::yuyv:
      result.bytes = yuv_of(rows, colour == nn::ImageColour::grey, place);
      break;
    case PixelLayout::metres:
      throw InputError(place, "an image to be looked at", "depth (32FC1)");
    default:
      result.bytes = checked_demosaic(rows.bytes(1), *bayer_pattern(rows.encoding->layout), place);
  }
  if (result.is_wide() && bits == nn::ImageBits::eight) {
    result.bytes = upper_bits(result.words, 16);
    result.words = {};
  }
  set_channels(result, colour);
  return result;
}

nn::ImageInfo info_of(const ImageMessage& image, const fs::path& place) {
  const Rows rows(image, place.string());
  nn::ImageInfo info;
  info.width = rows.width;
  info.height = rows.height;
  info.bit_depth = info.significant_bits = rows.encoding->layout == PixelLayout::grey16 ? 16 : 8;
  return info;
}

FloatImage depth_of(const ImageMessage& image, const fs::path& path) {
  const std::string place = path.string();
  const Rows rows(image, place);
  if (rows.encoding->layout == PixelLayout::metres)
    return known_metres(numbers_of<float>(rows, image.is_big_endian));
  if (rows.encoding->layout == PixelLayout::grey16)
    return metres_of(numbers_of<std::uint16_t>(rows, image.is_big_endian), kMillimetres);
  throw InputError(place, "depth (16UC1, mono16 or 32FC1)", fmt::format("{}", rows.encoding->name));
}

}  // namespace penumbra::slam
