// An image at falling resolutions: level l is the full image divided by s^l (bilinear, from the level below).
//
//   width_l = round(width / s^l);   pixel centres:  u_0 = (u_l + 1/2) width / width_l - 1/2
//
// The half pixels matter: without them a feature of level 7 sits 1.3 pixels off in the full image.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "nn/image/resize.h"

namespace penumbra::slam {

struct PyramidSettings {
  int levels = 8;
  double scale_factor = 1.2;  // s, above 1
};

// s^l for l = 0..levels-1: the size of a pixel of level l in pixels of the full image. The standard deviation
// of a corner's place is a share of it (slam/frontend/features/measurement.h).
std::vector<double> level_scales(const PyramidSettings& settings);

class ImagePyramid {
 public:
  // `grey`: 8-bit, one channel; level 0 shares its pixels. Levels that would be narrower or
  // lower than `smallest` pixels are left out. The memory of the last call is reused.
  void build(const ByteImage& grey, const PyramidSettings& settings, int smallest = 1);

  int levels() const { return used_; }
  const ByteImage& level(int l) const { return images_[static_cast<std::size_t>(l)]; }

  // Position on level l to the full image, and back.
  Eigen::Vector2f to_full(const Eigen::Vector2f& p, int l) const;
  Eigen::Vector2f to_level(const Eigen::Vector2f& p, int l) const;
  // Width of a pixel of level l in the full image.
  float scale_x(int l) const { return ratios_[static_cast<std::size_t>(l)].x(); }

 private:
  std::vector<ByteImage> images_;
  std::vector<LinearResize> resize_;     // to each level
  std::vector<Eigen::Vector2f> ratios_;  // size of the full image over the size of the level
  int used_ = 0;
};

}  // namespace penumbra::slam
