// Reads a depth map at an image's features: what stereo matching gives for a pair, here from an RGB-D camera.
//
//   u_right = u - fx b / Z       the column in which a right camera, b beside the real one, would see it
//
// With this virtual column RGB-D frames go through the same estimators as stereo pairs. b, a camera's nominal
// baseline, says how much an error of depth weighs: sigma_Z = sigma_u Z^2 / (fx b), as a structured-light
// sensor's depth behaves (Khoshelham, Oude Elberink, Sensors 2012).
// A depth image that was taken at another time than the colour image saw the scene from another pose. With
// the motion T_dc between them a feature's point p, its depth still unknown, is found by looking where it
// was:
//
//   p = z b_u,   u' = project(T_dc p),   z <- (T_dc^-1 Z(u') b_u').z
//   b_u = ((u - cx) / fx, (v - cy) / fy, 1)
//
// from z = Z(u), or where that is unknown, 2 m; two rounds, of which the second sees to parallax.
// Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-A.
#pragma once

#include "nn/image/image.h"
#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/stereo_matcher.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// `depth`: CV_32F of the camera's size, metres along z; 0, negative, infinite or NaN where unknown. The depth
// is that of the nearest pixel; features without one, or whose column would lie outside, get none. `T_dc`:
// from the camera when it took the colours to the camera when it took the depths.
void measure_depth(const StereoCamera& camera, const Features& features, const FloatImage& depth,
                   StereoMatches& matches, const SE3& T_dc = {});

}  // namespace penumbra::slam
