// From light to 8-bit pixels: exposure, gamma, noise.
//
//   grey level = 255 * encode(exposure * L) + noise,   encode(l) = l^(1/1.9) with a soft shoulder near white
//   L of a grey camera = 0.299 R + 0.587 G + 0.114 B;  noise: about Gaussian, sigma in grey levels,
//   a function of pixel, frame, camera and seed
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace penumbra::slam::synthetic {

struct SensorSettings {
  float exposure = 1.0F;
  float noise = 1.3F;            // sigma, grey levels
  std::uint32_t noise_seed = 0;  // different for every image
};

// What an automatic exposure makes of a view: it brings the mean light towards a middle grey, though not all
// the way, and hunts slowly by about +-10 % around it at `time` seconds. Both cameras of a pair share the
// left's.
float automatic_exposure(const cv::Mat3f& radiance, double time, std::uint32_t seed);

// `radiance` is linear red, green, blue. The results are allocated where needed.
void develop_grey(const cv::Mat3f& radiance, const SensorSettings& settings, cv::Mat1b& grey);
void develop_bgr(const cv::Mat3f& radiance, const SensorSettings& settings, cv::Mat3b& bgr);

}  // namespace penumbra::slam::synthetic
