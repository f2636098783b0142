// From light to 8-bit pixels: exposure, gamma, noise.
//
//   grey level = 255 * encode(exposure * L) + noise,   encode(l) = l^(1/1.9) with a soft shoulder near white
//   L of a grey camera = 0.299 R + 0.587 G + 0.114 B;  noise: about Gaussian, sigma in grey levels,
//   a function of pixel, frame, camera and seed
//
// Glare is stray light inside the lens, added before the exposure: a veil of the image's mean light, ghosts
// of the sun (soft discs on the line from the sun's image through the principal point) and sparkles that
// differ from image to image. Ghosts and sparkles are false features: they do not move with the world.
#pragma once

#include <cstdint>

#include "nn/image/image.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

struct SensorSettings {
  float exposure = 1.0F;
  float noise = 1.3F;            // sigma, grey levels
  std::uint32_t noise_seed = 0;  // different for every image
};

// About Gaussian with mean 0 and sigma 1: the sum of four uniform bytes of a hash.
float gaussian_noise(std::uint32_t hash);

// Adds glare of `strength` 0..1. `to_sun` is the sun's direction in the camera's frame; ghosts appear where
// it is within 75 degrees of the optical axis.
void add_glare(Image<Colour>& radiance, const StereoCamera& camera, const Eigen::Vector3f& to_sun,
               const Colour& sun_colour, float strength, std::uint32_t seed);

// What an automatic exposure makes of a view: it brings the mean light towards a middle grey, though not all
// the way, and hunts slowly by about +-`change` around it at `time` seconds. Both cameras of a pair share the
// left's.
float automatic_exposure(const Image<Colour>& radiance, double time, float change, std::uint32_t seed);

// `radiance` is linear red, green, blue. The results are allocated where needed.
void develop_grey(const Image<Colour>& radiance, const SensorSettings& settings, ByteImage& grey);
void develop_bgr(const Image<Colour>& radiance, const SensorSettings& settings, ByteImage& bgr);

}  // namespace penumbra::slam::synthetic
