#include "slam/frontend/features/image_pyramid.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam {

std::vector<double> level_scales(const PyramidSettings& settings) {
  std::vector<double> scales(static_cast<std::size_t>(settings.levels), 1.0);
  for (std::size_t l = 1; l < scales.size(); ++l) scales[l] = scales[l - 1] * settings.scale_factor;
  return scales;
}

void ImagePyramid::build(const ByteImage& grey, const PyramidSettings& settings, int smallest) {
  const std::vector<double> scales = level_scales(settings);
  images_.resize(scales.size());
  resize_.resize(scales.size());
  ratios_.resize(scales.size());
  used_ = 0;
  for (std::size_t l = 0; l < scales.size(); ++l) {
    const Size size{static_cast<int>(std::lround(grey.width() / scales[l])),
                    static_cast<int>(std::lround(grey.height() / scales[l]))};
    if (std::min(size.width, size.height) < std::max(smallest, 1)) break;
    if (l == 0) {
      images_[0] = grey;
    } else {
      resize_[l].apply(images_[l - 1], size, images_[l]);
    }
    ratios_[l] = {static_cast<float>(grey.width()) / static_cast<float>(size.width),
                  static_cast<float>(grey.height()) / static_cast<float>(size.height)};
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
