// Reads a depth map at an image's features: what stereo matching gives for a pair, here from an RGB-D camera.
//
//   u_right = u - fx b / Z       the column in which a right camera, b beside the real one, would see it
//
// With this virtual column RGB-D frames go through the same estimators as stereo pairs. b, a camera's nominal
// baseline, says how much an error of depth weighs: sigma_Z = sigma_u Z^2 / (fx b), as a structured-light
// sensor's depth behaves (Khoshelham, Oude Elberink, Sensors 2012).
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-A.
#pragma once

#include "nn/image/image.h"
#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/stereo_matcher.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// `depth`: CV_32F of the camera's size, metres along z; 0, negative, infinite or NaN where unknown. The depth
// is that of the nearest pixel; features without one, or whose column would lie outside, get none.
void measure_depth(const StereoCamera& camera, const Features& features, const FloatImage& depth,
                   StereoMatches& matches);

}  // namespace penumbra::slam
