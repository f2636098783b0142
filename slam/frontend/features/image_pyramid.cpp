#include "slam/frontend/features/image_pyramid.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace penumbra::slam {

std::vector<double> level_scales(const PyramidSettings& settings) {
  std::vector<double> scales(static_cast<std::size_t>(settings.levels), 1.0);
  for (std::size_t l = 1; l < scales.size(); ++l) scales[l] = scales[l - 1] * settings.scale_factor;
  return scales;
}

void ImagePyramid::build(const cv::Mat& grey, const PyramidSettings& settings, int smallest) {
  const std::vector<double> scales = level_scales(settings);
  images_.resize(scales.size());
  ratios_.resize(scales.size());
  used_ = 0;
  for (std::size_t l = 0; l < scales.size(); ++l) {
    const cv::Size size(static_cast<int>(std::lround(grey.cols / scales[l])),
                        static_cast<int>(std::lround(grey.rows / scales[l])));
    if (std::min(size.width, size.height) < std::max(smallest, 1)) break;
    if (l == 0) {
      images_[0] = grey;
    } else {
      cv::resize(images_[l - 1], images_[l], size, 0.0, 0.0, cv::INTER_LINEAR);
    }
    ratios_[l] = {static_cast<float>(grey.cols) / static_cast<float>(size.width),
                  static_cast<float>(grey.rows) / static_cast<float>(size.height)};
    ++used_;
  }
}

Eigen::Vector2f ImagePyramid::to_full(const Eigen::Vector2f& p, int l) const {
  const Eigen::Vector2f half(0.5F, 0.5F);
  return (p + half).cwiseProduct(ratios_[static_cast<std::size_t>(l)]) - half;
}

Eigen::Vector2f ImagePyramid::to_level(const Eigen::Vector2f& p, int l) const {
  const Eigen::Vector2f half(0.5F, 0.5F);
  return (p + half).cwiseQuotient(ratios_[static_cast<std::size_t>(l)]) - half;
}

}  // namespace penumbra::slam
