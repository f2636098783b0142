// What the depth cameras of depth_camera.h, which tells what the effects are, have of each.
#pragma once

#include <string>

namespace penumbra::slam::synthetic {

struct DepthCameraSettings {
  float focal_baseline = 43.0F;    // f b, pixels times metres
  float levels_a_metre = 5000.0F;  // of the images that are written

  float nearest = 0.45F, fade_from = 5.5F, farthest = 9.9F;  // metres
  float wobble = 1.6F;                                       // pixels
  float shadow_slope = 31.0F;                                // pixels times metres
  float shadow_trim_least = 1.0F, shadow_trim_most = 3.0F;   // pixels
  int shadow_extra_least = 0, shadow_extra_most = 0;         // pixels
  int gap_least = 4, gap_most = 6;                           // pixels
  float jump = 2.5F;                             // of d, from which there are gaps and flying pixels
  float dark_share = 0.30F, dark_level = 40.0F;  // holes below that grey level; none from 1.75 times it
  float glare_share = 0.56F;
  float scatter_share = 0.006F;
  float saturated_share = 0.0F;
  float patch_size = 9.0F;                        // pixels
  float patch_rate = 0.07F;                       // changes a frame
  float noise_near = 0.058F, noise_far = 0.040F;  // pixels of d
  // Shares of variance: means over squares of `wide` and `narrow` pixels, the rest white.
  int wide = 8, narrow = 3;
  float wide_share = 0.86F, narrow_share = 0.14F;
  float flying_share = 0.003F;
  float disparity_step = 0.125F;                                        // pixels of d
  float depth_step = 0.001F;                                            // metres
  int band_left = 11, band_right = 30, band_top = 13, band_bottom = 9;  // pixels at 640x480
};

// "kinect" or "d435"; throws UsageError for another name.
DepthCameraSettings depth_camera(const std::string& name);

}  // namespace penumbra::slam::synthetic
