// Finds the right image's column of left features, to a fraction of a pixel.
//
//   1. candidates: right features in the same row (band of 2 pixels of their level), neighbouring level,
//      disparity 0 < d <= fx; the one with the smallest Hamming distance, if that is below 75
//   2. SAD of an 11 x 11 patch, slid by -5..5 pixels along the row on the feature's level, both patches less
//      their centre's value
//   3. parabola through the SAD at the minimum and its neighbours:
//        delta = (S(-1) - S(1)) / (2 (S(-1) + S(1) - 2 S(0)))
//   4. pairs whose SAD is above 2.1 times the median are removed
//
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-A; own formulation. About 3 ms for 2000
// features.
#pragma once

#include <vector>

#include "slam/features/feature.h"
#include "slam/features/image_pyramid.h"
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
