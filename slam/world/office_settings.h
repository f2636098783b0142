// All that can be chosen about the office, who is in it and the camera that films it.
#pragma once

#include <optional>
#include <string>

#include "nn/image/image.h"
#include "slam/world/depth_camera_settings.h"

namespace penumbra::slam::synthetic {

enum class People { none, sitting, walking };

struct OfficeSettings {
  // The preset: what people do and how the camera moves; see office_preset.
  People people = People::walking;
  std::string path = "xyz";  // still, xyz, rpy, halfsphere, desk, twolaps, or a file of poses in TUM's format
  int frames = 0;            // 0: as long as the path usually is, or all of a file

  Size size{640, 480};  // pixels
  std::uint32_t seed = 1;
  float exposure_change = 0.06F;  // the exposure hunts by about this share
  float noise = 1.8F;             // sigma, grey levels
  float shutter = 0.0F;           // seconds that the shutter is open; 0: no motion blur
  float readout = 0.0F;           // seconds from the first row's exposure to the last one's; 0: all at once
  float depth_delay = 0.0F;       // seconds from each image to its depth
  float texture = 1.0F;           // contrast of the noise on surfaces
  std::optional<DepthCameraSettings> depth_camera = DepthCameraSettings{};  // empty: that of depth_sensor.h
  bool annotations = false, flow = false, amodal = false, landmarks = false;

  // Throws UsageError, naming the option, for values outside their range.
  void check() const;
};

// Whether office_preset knows the name.
bool is_office_preset(const std::string& name);
// "walking-xyz", "walking-static", "walking-rpy", "walking-halfsphere", the same four with "sitting", "desk"
// or "twolaps"; throws UsageError for another name.
OfficeSettings office_preset(const std::string& name);
// "walking", "sitting" or "none"; throws UsageError for another name.
People parse_people(const std::string& name);

}  // namespace penumbra::slam::synthetic
