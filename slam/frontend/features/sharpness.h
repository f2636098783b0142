// Is an image sharp enough to become a keyframe?
//
// Tenengrad: the mean over all pixels of S = gx^2 + gy^2 (Sobel) where S is above a threshold, 0 elsewhere.
// How large it is depends on the scene, so an image is compared with the ones before it: blurred if below a
// share of their running mean.
//
// Source: Tenenbaum (1970); used on keyframe candidates by Chen et al., Bionic SLAM, section on keyframes.
// Cost: 0.1 ms at 1034 x 313.
#pragma once

#include "nn/image/image.h"

namespace penumbra::slam {

// `grey`: 8-bit, one channel. `threshold`: squared gradient, grey values^2 per pixel^2.
double tenengrad(const ByteView& grey, double threshold = 400.0);

class SharpnessTest {
 public:
  // `least_share` of the mean sharpness that an image needs; 0: every image passes, and nothing is computed.
  explicit SharpnessTest(double least_share) : least_share_(least_share) {}

  // Takes the next image: whether it is sharp. The first one is.
  bool is_sharp(const ByteView& grey);

 private:
  double least_share_;
  double mean_ = 0.0;  // of about the last ten images
  bool any_ = false;
};

}  // namespace penumbra::slam
