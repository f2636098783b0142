// What two common depth cameras make of true depth: a Kinect v1 as the TUM RGB-D benchmark used it, and a
// RealSense D435 whose depth is aligned to its colour image.
//
// Both measure a disparity d = f b / z in pixels of their own; every effect has its numbers here and is off
// where they are 0. In this order:
//
//   range      no depth nearer than `nearest`; beyond `fade_from` more and more holes, all from `farthest` on
//   wobble     edges of things are displaced by up to so many pixels, as by the window that is matched
//   shadow     what the projector (Kinect) or the second imager (D435), to the right of the camera, does not
//              see: left of a near thing's edge, shadow_slope (1/z_near - 1/z_far) pixels wide, less
//              shadow_trim or more by shadow_extra, which differ from row to row
//   gap        right of a near thing the window that is matched lies on both surfaces
//   dark       surfaces that send little back: holes over patches of about patch_size pixels which come and
//   go glare      where sun or lamps outshine the pattern: grey above 230 scatter    holes anywhere saturated
//   the D435 writes 65535 where it finds disparity 0: lamps, some places far away noise      Gaussian in d:
//   sigma between noise_near (at 1 m) and noise_far (at 3 m), correlated over the
//              window that is matched: a sum of white noise and of two means over squares of it
//   flying     pixels at a jump whose depth lies between both sides
//   steps      d in steps of disparity_step, then z in steps of depth_step
//   band       the border that the turn into the colour camera's frame leaves empty
//
// Sources: for the numbers, frames of TUM fr1/xyz and fr3/walking_xyz and of a D435, measured by
// docs/images/compare_depth_cameras.py; for the effects, Khoshelham and Elberink, Accuracy and Resolution of
// Kinect Depth Data, Sensors 2012 (steps, noise, shadow); Mallick, Das, Majumdar, Characterizations of Noise
// in Kinect Depth Images, IEEE Sensors Journal 2014 (dark and bright surfaces, gaps, holes that come and go);
// Ahn et al., Analysis and Noise Modeling of the Intel RealSense D435, UR 2019 (noise, shadow of the D435).
#pragma once

#include <cstdint>

#include "nn/image/image.h"
#include "slam/world/depth_camera_settings.h"
#include "slam/world/ray_caster.h"

namespace penumbra::slam::synthetic {

constexpr float kSaturatedDepth = -1.0F;  // stands for 65535

class DepthCamera {
 public:
  explicit DepthCamera(const DepthCameraSettings& settings, std::uint32_t seed)
      : settings_(settings), seed_(seed) {}

  const DepthCameraSettings& settings() const { return settings_; }
  // `depth` in metres, 0 = hole, from the true depth and the colour image of frame `number`. About 10 ms at
  // 640x480 on two threads.
  void sense(const FloatImage& truth, const ByteImage& bgr, int number, FloatImage& depth);

 private:
  void make_noise(const Size& size, int number);
  void displace_edges(const FloatImage& truth, int number);
  void cast_shadows(const FloatImage& seen, int row, int number, FloatImage& depth) const;
  bool is_lost(float z, float grey, int column, int row, int number, bool& saturated) const;

  DepthCameraSettings settings_;
  std::uint32_t seed_;
  FloatImage seen_;                   // the true depth with displaced edges
  FloatImage noise_, wide_, narrow_;  // wide_ and narrow_: sums along rows
};

// `depth` as levels: 0 = hole, 65535 = saturated.
WordImage encode_sensed_depth(const FloatImage& depth, float levels_a_metre);

}  // namespace penumbra::slam::synthetic
