// Finds the right image's column of left features, to a fraction of a pixel.
//
//   1. candidates: right features in the same row (band of 2 pixels of their level), neighbouring level,
//      disparity 0 < d <= fx; the pairs that are each other's nearest in Hamming distance, below 75
//   2. SAD of an 11 x 11 patch, slid by -5..5 pixels along the row on the feature's level, both patches less
//      their centre's value
//   3. from the best whole pixel x, Gauss-Newton on  sum (L(p) - R(p + x) - mean difference)^2  over the
//        patch: x <- x - sum g~ (R(p + x) - L(p)) / sum g~^2,   g~ = slope of L along the row less its mean
//   4. pairs whose SAD is above 2.1 times the median are removed
//
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-A; with step 3 in place of
// its parabola, which is drawn towards whole pixels (Lucas, Kanade 1981; Baker, Matthews 2004). About 4 ms
// for 2000 features.
#pragma once

#include <vector>

#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/image_pyramid.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

struct StereoMatches {
  std::vector<float> u_right;  // per left feature: column in the right image, pixels; -1 without a match
  std::vector<float> depth;    // metres; -1 without a match
  int count = 0;
};

// The pyramids are those that the features were found on.
void match_stereo(const StereoCamera& camera, const Features& left, const Features& right,
                  const ImagePyramid& left_pyramid, const ImagePyramid& right_pyramid,
                  StereoMatches& matches);

}  // namespace penumbra::slam
