// Finds out where a frame's features are from the patches of the points that they show.
//
// A corner's place is known to a pixel of its level at best, the same corner's place in two images relative
// to each other to a tenth, by comparing grey values. Every point carries a patch from the last keyframe in
// which it was found; a feature that was matched to the point by its descriptor is moved to where that patch
// fits. The patch is looked for on the level on which it has about the size that it had:
//
//   size = s_l Z_patch / Z       pixels of the full image per pixel of the patch; s_l: scale of its level
//   level with the nearest scale s_m, ratio = size / s_m
//
// About 3 microseconds a feature.
#pragma once

#include <vector>

#include "slam/frontend/features/feature_view.h"
#include "slam/frontend/features/image_pyramid.h"
#include "slam/frontend/features/patch_alignment.h"

namespace penumbra::slam {

class FeatureRefiner {
 public:
  // `scales`: level_scales of the pyramid.
  FeatureRefiner(const ImagePyramid& pyramid, const std::vector<double>& scales)
      : pyramid_(pyramid), scales_(scales) {}

  // `patch` shows the point at `patch_depth`, metres; in this image it is expected at `expected`, at `depth`.
  // True where it was found, near `pixel`, the place of a feature of `feature_level`: then that was moved,
  // its right column along with it.
  bool refine(FeaturePixel& pixel, int feature_level, const Patch& patch, double patch_depth,
              const Eigen::Vector2d& expected, double depth) const;

 private:
  const ImagePyramid& pyramid_;
  const std::vector<double>& scales_;
  PatchAlignmentSettings settings_;
};

}  // namespace penumbra::slam
