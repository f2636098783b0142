#include "slam/datasets/synthetic/camera_sensor.h"

#include <array>
#include <cmath>

#include "slam/datasets/synthetic/noise.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr int kLevels = 4096;
constexpr float kWhite = 2.0F;  // light that saturates

// Grey level (0..255) of light up to kWhite: gamma, then a shoulder that keeps bright walls apart.
const std::array<float, kLevels + 1>& encoding() {
  static const std::array<float, kLevels + 1> table = [] {
    std::array<float, kLevels + 1> levels{};
    for (int i = 0; i <= kLevels; ++i) {
      const float light = kWhite * static_cast<float>(i) / kLevels;
      const float compressed = light * (1.0F + 0.25F * light) / (1.0F + 0.75F * light);
      levels[static_cast<std::size_t>(i)] =
          255.0F * std::min(1.0F, std::pow(compressed * 1.08F, 1.0F / 1.9F));
    }
    return levels;
  }();
  return table;
}

// About Gaussian with sigma 1: the sum of four uniform bytes of a hash.
float noise_of(std::uint32_t h) {
  const auto sum = static_cast<float>((h & 255U) + ((h >> 8) & 255U) + ((h >> 16) & 255U) + (h >> 24));
  return (sum - 510.0F) * (1.0F / 147.8F);
}

std::uint8_t level(float light, float noise) {
  const float position = std::min(std::max(light, 0.0F) * (kLevels / kWhite), static_cast<float>(kLevels));
  const float value = encoding()[static_cast<std::size_t>(position)] + noise + 0.5F;
  return static_cast<std::uint8_t>(std::min(std::max(value, 0.0F), 255.0F));
}

}  // namespace

float automatic_exposure(const cv::Mat3f& radiance, double time, std::uint32_t seed) {
  constexpr int kStep = 4;  // every fourth pixel each way is enough for a mean
  constexpr float kMiddle = 0.32F, kStrength = 0.8F;
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < radiance.rows; row += kStep) {
    for (int column = 0; column < radiance.cols; column += kStep) {
      sum += std::min(static_cast<double>(radiance(row, column)[1]), 1.0);
      ++count;
    }
  }
  const auto mean = static_cast<float>(sum / count) + 1e-3F;
  const float hunting = 1.0F + 0.1F * value_noise(static_cast<float>(time) * 0.35F, 0.5F, seed);
  return std::pow(kMiddle / mean, kStrength) * hunting;
}

void develop_grey(const cv::Mat3f& radiance, const SensorSettings& settings, cv::Mat1b& grey) {
  grey.create(radiance.size());
#pragma omp parallel for schedule(static)
  for (int row = 0; row < radiance.rows; ++row) {
    for (int column = 0; column < radiance.cols; ++column) {
      const cv::Vec3f& light = radiance(row, column);
      const auto pixel = static_cast<std::uint32_t>(row * radiance.cols + column);
      const float noise = settings.noise * noise_of(mix_bits(pixel * 0x9e3779b1U + settings.noise_seed));
      const float sum = 0.299F * light[0] + 0.587F * light[1] + 0.114F * light[2];
      grey(row, column) = level(sum * settings.exposure, noise);
    }
  }
}

void develop_bgr(const cv::Mat3f& radiance, const SensorSettings& settings, cv::Mat3b& bgr) {
  bgr.create(radiance.size());
#pragma omp parallel for schedule(static)
  for (int row = 0; row < radiance.rows; ++row) {
    for (int column = 0; column < radiance.cols; ++column) {
      const cv::Vec3f& light = radiance(row, column);
      const auto pixel = static_cast<std::uint32_t>(row * radiance.cols + column);
      for (int channel = 0; channel < 3; ++channel) {
        const std::uint32_t h = mix_bits(pixel * 0x9e3779b1U + settings.noise_seed +
                                         static_cast<std::uint32_t>(channel) * 0x632be5abU);
        bgr(row, column)[2 - channel] =
            level(light[channel] * settings.exposure, settings.noise * noise_of(h));
      }
    }
  }
}

}  // namespace penumbra::slam::synthetic
