#include "slam/world/depth_camera_settings.h"

#include "nn/base/error.h"

namespace penumbra::slam::synthetic {

DepthCameraSettings depth_camera(const std::string& name) {
  DepthCameraSettings settings;
  if (name == "kinect") return settings;
  if (name != "d435")
    throw UsageError(fmt::format("--depth-sensor: expected 'simple', 'kinect' or 'd435', found '{}'", name));
  settings.focal_baseline = 19.3F;
  settings.levels_a_metre = 1000.0F;
  settings.nearest = 0.28F;
  settings.fade_from = 20.0F;
  settings.farthest = 62.0F;
  settings.shadow_trim_least = settings.shadow_trim_most = 1.0F;
  settings.shadow_extra_least = 6;
  settings.shadow_extra_most = 15;
  settings.gap_least = settings.gap_most = 0;
  settings.jump = 2.5F;
  settings.dark_share = 0.10F;
  settings.glare_share = 0.02F;
  settings.scatter_share = 0.005F;
  settings.saturated_share = 0.02F;
  settings.wobble = 1.0F;
  settings.patch_size = 8.0F;
  settings.patch_rate = 0.9F;
  settings.noise_near = settings.noise_far = 0.027F;
  settings.wide = 13;
  settings.narrow = 5;
  settings.wide_share = 0.92F;
  settings.narrow_share = 0.08F;
  settings.flying_share = 0.0F;
  settings.disparity_step = 1.0F / 32.0F;
  settings.band_left = settings.band_right = settings.band_top = settings.band_bottom = 0;
  return settings;
}

}  // namespace penumbra::slam::synthetic
