#include "slam/sources/live/video_pixels.h"

#include <algorithm>

#include "nn/image/image_file.h"
#include "nn/image/yuv.h"

namespace penumbra::slam {

namespace {

// Two pixels in four bytes; where the brightness of the first lies, and its colours.
struct PairOrder {
  int y, u, v;
};

ByteImage grey_rows(const VideoFormat& format, const std::uint8_t* bytes, int step, int first) {
  ByteImage image(format.size.width, format.size.height);
  for (int y = 0; y < image.height(); ++y, bytes += format.bytes_per_line) {
    std::uint8_t* const row = image.row(y);
    for (int x = 0; x < image.width(); ++x) row[x] = bytes[step * x + first];
  }
  return image;
}

ByteImage colour_rows(const VideoFormat& format, const std::uint8_t* bytes, const PairOrder& order) {
  const YuvRange& range = format.full_range ? kFullRange : kVideoRange;
  ByteImage image(format.size.width, format.size.height, 3);
  for (int y = 0; y < image.height(); ++y, bytes += format.bytes_per_line) {
    std::uint8_t* bgr = image.row(y);
    for (int x = 0; x < image.width(); ++x, bgr += 3) {
      const std::uint8_t* const pair = bytes + 4 * (x / 2);
      put_bgr(range, pair[order.y + 2 * (x % 2)], pair[order.u], pair[order.v], bgr);
    }
  }
  return image;
}

}  // namespace

ByteImage image_of_video(const VideoFormat& format, std::span<const std::uint8_t> bytes, bool colour,
                         const std::string& place) {
  switch (format.pixels) {
    case VideoPixels::grey:
      return grey_rows(format, bytes.data(), 1, 0);
    case VideoPixels::yuyv:
      return colour ? colour_rows(format, bytes.data(), {0, 1, 3}) : grey_rows(format, bytes.data(), 2, 0);
    case VideoPixels::uyvy:
      return colour ? colour_rows(format, bytes.data(), {1, 0, 2}) : grey_rows(format, bytes.data(), 2, 1);
    case VideoPixels::mjpg:
      break;
  }
  const auto wanted = colour ? nn::ImageColour::bgr : nn::ImageColour::grey;
  return nn::decode_image(std::string(bytes.begin(), bytes.end()), wanted, nn::ImageBits::eight, place).bytes;
}

}  // namespace penumbra::slam
