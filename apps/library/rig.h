// What a Rig holds.
#pragma once

#include "penumbra/slam.h"
#include "slam/sources/calibration/calibration.h"

namespace penumbra {

struct Rig::Parts {
  slam::Sensor sensor = slam::Sensor::stereo;
  slam::RecordedCamera cameras;
  int width = 0, height = 0;  // of the raw images
  double depth_factor = 1.0;  // units of 16-bit depth a metre
};

}  // namespace penumbra
