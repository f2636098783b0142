#include "nn/io/image_file.h"

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "nn/io/image_container.h"

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

cv::Mat decode_image(const std::filesystem::path& path, int flags, std::string_view expected) {
  silence_opencv();
  const std::string place = path.string();
  std::string bytes = read_file(path, expected);
  if (bytes.empty()) throw InputError(place, expected, "an empty file");

  ImageSize size;
  if (looks_like_png(bytes)) {
    size = check_png(bytes, place);
  } else if (looks_like_jpeg(bytes)) {
    size = check_jpeg(bytes, place);
  } else {
    throw InputError(place, expected, "a file that is neither");
  }

  cv::Mat image;
  std::string reason = "a file that the decoder refuses";
  try {
    image = cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data()), flags);
  } catch (const cv::Exception& error) {
    reason += ": " + error.err;
  }
  if (image.cols != size.width || image.rows != size.height) throw InputError(place, expected, reason);
  return image;
}

}  // namespace

cv::Mat read_image(const std::filesystem::path& path, ImageColour colour) {
  const int flags =
      (colour == ImageColour::grey ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR) | cv::IMREAD_IGNORE_ORIENTATION;
  return decode_image(path, flags, "a PNG or JPEG image");
}

cv::Mat1w read_depth_image(const std::filesystem::path& path) {
  constexpr std::string_view kExpected = "a 16-bit grey PNG with depth";
  const cv::Mat image = decode_image(path, cv::IMREAD_UNCHANGED, kExpected);
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
