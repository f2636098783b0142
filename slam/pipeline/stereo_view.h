// A view of the dense map from a stereo pair: both images made smaller, the disparity of most pixels found
// (slam/frontend/disparity/dense_disparity.h), depth from it.
//
//   z = fx b / (d - d0),    camera of the small image:  fx s, fy s, (cx + 1/2) s - 1/2, likewise cy, d0 s
//
// s being the small image's size to the pair's. Cost: dense_disparity.h's, 3.5 ms on one thread for a
// pair of 1241 x 376 at a fourth, and making the images small.
#pragma once

#include "slam/map/dense/dense_view.h"
#include "slam/pipeline/dense_settings.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

class StereoViewMaker {
 public:
  // `farthest`: metres that the views' depths must reach.
  StereoViewMaker(const StereoDepthSettings& settings, double farthest);

  // `images`: a pair of the camera's size.
  DenseView make(const StereoCamera& camera, const StereoImages& images);

 private:
  const int shrink_;
  const float units_;  // a metre
  DenseDisparity disparity_;
  FloatImage depth_;
};

}  // namespace penumbra::slam
