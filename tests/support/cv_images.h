// Between our images and OpenCV's, which is the oracle of tests and nothing more.
#pragma once

#include <opencv2/core.hpp>

#include "nn/image/image_file.h"

namespace penumbra::test {

// All copy.
template <class T>
cv::Mat to_mat(const ImageView<const T>& image) {
  constexpr int depth = sizeof(T) == 1 ? CV_8U : sizeof(T) == 2 ? CV_16U : CV_32F;
  if (image.empty()) return {};
  return cv::Mat(image.height, image.width, CV_MAKETYPE(depth, image.channels), const_cast<T*>(image.data),
                 static_cast<std::size_t>(image.pitch) * sizeof(T))
      .clone();
}
template <class T>
cv::Mat to_mat(const Image<T>& image) {
  return to_mat<T>(image.view());
}
inline cv::Mat to_mat(const nn::StoredImage& image) {
  return image.is_wide() ? to_mat(image.words) : to_mat(image.bytes);
}

template <class T>
Image<T> to_image(const cv::Mat& mat) {
  if (mat.empty()) return {};
  return Image<T>::copy_of(
      {mat.ptr<T>(), mat.cols, mat.rows, mat.channels(), static_cast<std::ptrdiff_t>(mat.step1())});
}
inline ByteImage byte_image(const cv::Mat& mat) { return to_image<std::uint8_t>(mat); }

// nn::read_image and nn::write_image of OpenCV's images.
template <class... Arguments>
cv::Mat read_mat(Arguments... arguments) {
  return to_mat(nn::read_image(arguments...));
}
inline void write_mat(const std::filesystem::path& path, const cv::Mat& image) {
  if (image.depth() == CV_16U) {
    nn::write_image(path, to_image<std::uint16_t>(image).view());
  } else {
    nn::write_image(path, byte_image(image));
  }
}

}  // namespace penumbra::test
