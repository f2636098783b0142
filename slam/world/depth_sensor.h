// What a depth camera that projects a pattern makes of true depth.
//
//   sigma(Z) = 0.0014 Z^2                  metres; Gaussian, from the pattern's disparity noise
//   range      0.4 m .. 12 m               nothing nearer or farther
//   holes      where little of the pattern comes back: dark surfaces, glass and paint, each with patches of a
//              few pixels that come and go; and in the projector's shadow, left of a nearer surface's edge:
//              gap = fx 0.075 (1/Z_near - 1/Z_far) pixels for a projector 0.075 m to the right of the camera
//
// Source: Khoshelham and Elberink, Accuracy and Resolution of Kinect Depth Data, Sensors 2012 (sigma,
// shadow).
#pragma once

#include <cstdint>

#include "nn/image/image.h"
#include "slam/world/ray_caster.h"

namespace penumbra::slam::synthetic {

constexpr float kDepthNoise = 0.0014F;                           // sigma / Z^2, 1/metres
constexpr float kNearestSensed = 0.4F, kFarthestSensed = 12.0F;  // metres
constexpr double kProjectorBaseline = 0.075;                     // metres

// `view` must have its reflectance. The result is in metres, 0 = hole, allocated where needed.
void sense_depth(const RenderedView& view, const StereoCamera& camera, std::uint32_t seed, FloatImage& depth);

}  // namespace penumbra::slam::synthetic
