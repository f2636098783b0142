#include "slam/frontend/locating/feature_refiner.h"

#include <algorithm>
#include <cmath>

#include "slam/frontend/features/level_of_size.h"

namespace penumbra::slam {

bool FeatureRefiner::refine(FeaturePixel& pixel, int feature_level, const Patch& patch, double patch_depth,
                            const Eigen::Vector2d& expected, double depth) const {
  if (patch.empty() || !(patch_depth > 0.0 && depth > 0.0) || pyramid_.levels() == 0) return false;
  const double nearer = patch_depth / depth;
  const double size = scales_[static_cast<std::size_t>(patch.level)] * nearer;
  const double unclamped = std::round(level_of_size(size, level_step(scales_)));
  const int level = static_cast<int>(std::clamp(unclamped, 0.0, pyramid_.levels() - 1.0));
  const float ratio = static_cast<float>(size / scales_[static_cast<std::size_t>(level)]);
  const Eigen::Vector2f offset = static_cast<float>(nearer) * patch.offset;
  const std::optional<Eigen::Vector2f> found =
      align_patch(patch, ratio, pyramid_.level(level),
                  pyramid_.to_level(expected.cast<float>() - offset, level), settings_);
  if (!found) return false;
  const Eigen::Vector2f position = pyramid_.to_full(*found, level) + offset;
  const float farthest =
      settings_.farthest * static_cast<float>(scales_[static_cast<std::size_t>(feature_level)]);
  if ((position - Eigen::Vector2f(pixel.u, pixel.v)).norm() > farthest) return false;
  if (pixel.u_right >= 0.0F) pixel.u_right = std::max(0.0F, pixel.u_right + position.x() - pixel.u);
  pixel.u = position.x();
  pixel.v = position.y();
  return true;
}

}  // namespace penumbra::slam
