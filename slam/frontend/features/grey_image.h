// An image as the features see it: grey values alone.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace penumbra::slam {

// `image`: 8 bits, grey or BGR. A grey one is returned as it is, its pixels shared.
inline cv::Mat to_grey(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace penumbra::slam
