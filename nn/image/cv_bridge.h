// Between our images and OpenCV's, without copying. For the time in which both are used.
#pragma once

#include <opencv2/core.hpp>

#include "nn/image/image.h"

namespace penumbra {

// Looks at `image`, which must stay alive.
template <class T>
cv::Mat as_mat(const ImageView<const T>& image) {
  constexpr int depth = sizeof(T) == 1 ? CV_8U : sizeof(T) == 2 ? CV_16U : CV_32F;
  return {image.height, image.width, CV_MAKETYPE(depth, image.channels), const_cast<T*>(image.data),
          static_cast<std::size_t>(image.pitch) * sizeof(T)};
}
template <class T>
cv::Mat as_mat(const Image<T>& image) {
  return image.empty() ? cv::Mat() : as_mat<T>(image.view());
}

// A copy.
template <class T>
Image<T> from_mat(const cv::Mat& mat) {
  if (mat.empty()) return {};
  return Image<T>::copy_of(
      {mat.ptr<T>(), mat.cols, mat.rows, mat.channels(), static_cast<std::ptrdiff_t>(mat.step1())});
}

}  // namespace penumbra
