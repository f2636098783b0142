#include "nn/image/image_file.h"

#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/bmp.h"
#include "nn/image/exif.h"
#include "nn/image/foreign_image.h"
#include "nn/image/image_container.h"
#include "nn/image/netpbm.h"

namespace penumbra::nn {

namespace {

// Our exceptions say what is wrong; OpenCV would print its own opinion beside them.
void silence_opencv() {
  static const bool done = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  static_cast<void>(done);
}

std::string read_image_bytes(const std::filesystem::path& path, std::string_view expected) {
  std::string bytes = read_file(path, expected);
  if (bytes.empty()) throw InputError(path.string(), expected, "an empty file");
  return bytes;
}

// What a PNG or JPEG says about itself, none for other files.
std::optional<ImageInfo> check_container(std::string& bytes, const std::string& place) {
  if (looks_like_png(bytes)) return check_png(bytes, place);
  if (looks_like_jpeg(bytes)) return check_jpeg(bytes, place);
  return std::nullopt;
}

// An image of the formats whose rows are read here.
StoredImage read_plain_rows(const std::string& bytes, const std::filesystem::path& path,
                            std::string_view expected) {
  const std::string place = path.string();
  if (looks_like_netpbm(bytes)) return read_netpbm(bytes, place);
  if (looks_like_bmp(bytes)) return read_bmp(bytes, place);
  throw InputError(place, expected, describe_foreign_image(bytes, path));
}

cv::Mat convert_colour(const cv::Mat& image, ImageColour colour) {
  const int channels = colour == ImageColour::grey ? 1 : 3;
  if (image.channels() == channels) return image;
  cv::Mat converted;
  cv::cvtColor(image, converted, channels == 1 ? cv::COLOR_BGR2GRAY : cv::COLOR_GRAY2BGR);
  return converted;
}

// All bits of the file's channels, or 8.
enum class BitDepth { stored, eight };

StoredImage decode_image(const std::filesystem::path& path, std::optional<ImageColour> colour, BitDepth depth,
                         std::string_view expected) {
  silence_opencv();
  const std::string place = path.string();
  std::string bytes = read_image_bytes(path, expected);
  const std::optional<ImageInfo> info = check_container(bytes, place);
  if (!info) {
    StoredImage image = read_plain_rows(bytes, path, expected);
    if (depth == BitDepth::eight && image.pixels.depth() == CV_16U) {
      // The significant bits lie low; what they scale to is rounded down, as libpng does.
      const double scale = std::ldexp(1.0, 8 - image.info.significant_bits);
      image.pixels.convertTo(image.pixels, CV_8U, scale, scale < 1.0 ? 0.5 * scale - 0.5 : 0.0);
    }
    if (colour) image.pixels = convert_colour(image.pixels, *colour);
    return image;
  }

  int flags = cv::IMREAD_UNCHANGED;
  if (colour) {
    flags = (*colour == ImageColour::grey ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR) |
            cv::IMREAD_IGNORE_ORIENTATION | (depth == BitDepth::stored ? cv::IMREAD_ANYDEPTH : 0);
  }
  StoredImage image{{}, *info};
  std::string reason = "a file that the decoder refuses";
  try {
    image.pixels = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data()), flags);
  } catch (const cv::Exception& error) {
    reason += ": " + error.err;
  }
  if (image.pixels.cols != info->width || image.pixels.rows != info->height) {
    throw InputError(place, expected, reason);
  }
  return image;
}

}  // namespace

cv::Mat read_image(const std::filesystem::path& path, ImageColour colour, ImageOrientation orientation) {
  const StoredImage image = decode_image(path, colour, BitDepth::eight, kReadImages);
  return orientation == ImageOrientation::upright ? turn_upright(image.pixels, image.info.orientation)
                                                  : image.pixels;
}

cv::Mat read_stored_image(const std::filesystem::path& path, ImageColour colour) {
  return decode_image(path, colour, BitDepth::stored, kReadImages).pixels;
}

ImageInfo read_image_info(const std::filesystem::path& path) {
  std::string bytes = read_image_bytes(path, kReadImages);
  const std::optional<ImageInfo> info = check_container(bytes, path.string());
  return info ? *info : read_plain_rows(bytes, path, kReadImages).info;
}

cv::Mat1w read_depth_image(const std::filesystem::path& path) {
  constexpr std::string_view kExpected = "a 16-bit grey PNG (or PGM) with depth";
  const cv::Mat image = decode_image(path, std::nullopt, BitDepth::stored, kExpected).pixels;
  if (image.type() != CV_16UC1) {
    throw InputError(path.string(), kExpected,
                     fmt::format("{} channels of {} bits", image.channels(), 8 * image.elemSize1()));
  }
  return image;
}

void write_image(const std::filesystem::path& path, const cv::Mat& image) {
  silence_opencv();
  std::vector<unsigned char> bytes;
  std::string reason;
  try {
    if (!cv::imencode(path.extension().string(), image, bytes)) reason = "the encoder failed";
  } catch (const cv::Exception& error) {
    reason = error.err;
  }
  if (!reason.empty()) throw Error(fmt::format("{}: cannot encode the image: {}", path.string(), reason));
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, /*durable=*/false);
}

}  // namespace penumbra::nn
