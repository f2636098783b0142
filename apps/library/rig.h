// What a Rig holds.
#pragma once

#include "nn/image/remap.h"
#include "penumbra/slam.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra {

struct Rig::Parts {
  slam::Sensor sensor = slam::Sensor::stereo;
  slam::StereoCamera camera;  // of the rectified images
  Remap left, right;          // to rectified images
  int width = 0, height = 0;  // of the raw ones
  double depth_factor = 1.0;  // units of 16-bit depth a metre
};

}  // namespace penumbra
