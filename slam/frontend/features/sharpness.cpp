#include "slam/frontend/features/sharpness.h"

#include <opencv2/imgproc.hpp>

namespace penumbra::slam {

double tenengrad(const cv::Mat& grey, double threshold) {
  if (grey.empty()) return 0.0;
  cv::Mat gx, gy;
  // Sobel's kernel of 3 x 3 sums to 8 slopes of a pixel.
  cv::Sobel(grey, gx, CV_32F, 1, 0, 3, 1.0 / 8.0);
  cv::Sobel(grey, gy, CV_32F, 0, 1, 3, 1.0 / 8.0);
  double sum = 0.0;
  for (int y = 0; y < grey.rows; ++y) {
    const float *x_row = gx.ptr<float>(y), *y_row = gy.ptr<float>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const double S = static_cast<double>(x_row[x]) * x_row[x] + static_cast<double>(y_row[x]) * y_row[x];
      if (S > threshold) sum += S;
    }
  }
  return sum / static_cast<double>(grey.total());
}

bool SharpnessTest::is_sharp(const cv::Mat& grey) {
  if (least_share_ <= 0.0) return true;
  constexpr double kMemory = 0.9;
  const double sharpness = tenengrad(grey);
  const bool sharp = !any_ || sharpness >= least_share_ * mean_;
  mean_ = any_ ? kMemory * mean_ + (1.0 - kMemory) * sharpness : sharpness;
  any_ = true;
  return sharp;
}

}  // namespace penumbra::slam
