#include "slam/sources/live/video_pixels.h"

#include "nn/image/image_file.h"
#include "nn/image/yuv422.h"

namespace penumbra::slam {

ByteImage image_of_video(const VideoFormat& format, std::span<const std::uint8_t> bytes, bool colour,
                         const std::string& place) {
  if (format.pixels != VideoPixels::mjpg) {
    const ByteView rows{bytes.data(), format.size.width, format.size.height,
                        static_cast<int>(bytes_per_pixel(format.pixels)),
                        static_cast<std::ptrdiff_t>(format.bytes_per_line)};
    if (format.pixels == VideoPixels::grey) return ByteImage::copy_of(rows);
    const Yuv422Order order = format.pixels == VideoPixels::yuyv ? Yuv422Order::yuyv : Yuv422Order::uyvy;
    return colour ? bgr_of_yuv422(rows, order, format.full_range ? kFullRange : kVideoRange)
                  : grey_of_yuv422(rows, order);
  }
  const auto wanted = colour ? nn::ImageColour::bgr : nn::ImageColour::grey;
  return nn::decode_image(std::string(bytes.begin(), bytes.end()), wanted, nn::ImageBits::eight, place).bytes;
}

}  // namespace penumbra::slam
