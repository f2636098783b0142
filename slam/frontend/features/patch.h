// The grey values around a feature, by which it is found again to a fraction of a pixel.
//
// 15 x 15 pixels of the pyramid level that the feature was found on, so that the window of the alignment
// (slam/frontend/features/patch_alignment.h) and its slopes have room to be drawn up to a sixth smaller.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "slam/frontend/features/feature_view.h"
#include "slam/frontend/features/image_pyramid.h"

namespace penumbra::slam {

struct Patch {
  static constexpr int kHalf = 7, kWidth = 2 * kHalf + 1;

  std::array<std::uint8_t, kWidth * kWidth> pixels{};  // row by row
  int level = -1;                                      // of the pyramid; -1: no patch
  // The feature lies this far from the middle of the patch's middle pixel, pixels of the full image.
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();

  bool empty() const { return level < 0; }
};

// The patch around `keypoint`; empty where it would leave the image.
Patch extract_patch(const ImagePyramid& pyramid, const Keypoint& keypoint);
// Around every feature, where it is known to be by now.
std::vector<Patch> extract_patches(const ImagePyramid& pyramid, const FeatureView& features);

}  // namespace penumbra::slam
