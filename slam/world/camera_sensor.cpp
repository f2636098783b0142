#include "slam/world/camera_sensor.h"

#include <array>
#include <cmath>
#include <span>

#include "nn/base/parallel.h"
#include "slam/world/noise.h"

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

std::uint8_t level(float light, float noise) {
  const float position = std::min(std::max(light, 0.0F) * (kLevels / kWhite), static_cast<float>(kLevels));
  const float value = encoding()[static_cast<std::size_t>(position)] + noise + 0.5F;
  return static_cast<std::uint8_t>(std::min(std::max(value, 0.0F), 255.0F));
}

}  // namespace

float gaussian_noise(std::uint32_t hash) {
  const auto sum =
      static_cast<float>((hash & 255U) + ((hash >> 8) & 255U) + ((hash >> 16) & 255U) + (hash >> 24));
  return (sum - 510.0F) * (1.0F / 147.8F);
}

void add_glare(Image<Colour>& radiance, const StereoCamera& camera, const Eigen::Vector3f& to_sun,
               const Colour& sun_colour, float strength, std::uint32_t seed) {
  const std::span<Colour> lights(radiance.data(), radiance.elements());
  double green = 0.0;
  for (const Colour& light : lights) green += static_cast<double>(light.y());
  const double mean = green / static_cast<double>(lights.size());
  const auto veil = static_cast<float>(0.5 * static_cast<double>(strength) * mean);
  for (Colour& light : lights) light += Colour::Constant(veil);
  // Light that falls off from the middle of a disc to its rim.
  const auto add_disc = [&](float u, float v, float radius, const Colour& light) {
    const int top = std::max(0, floor_int(v - radius)), left = std::max(0, floor_int(u - radius));
    const int bottom = std::min(radiance.height() - 1, floor_int(v + radius) + 1);
    const int right = std::min(radiance.width() - 1, floor_int(u + radius) + 1);
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        const float distance = std::hypot(static_cast<float>(column) - u, static_cast<float>(row) - v);
        const Colour added = light * (1.0F - smooth_step(0.8F * radius, radius, distance));
        radiance.at(column, row) += added;
      }
    }
  };
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  if (to_sun.z() > 0.26F) {
    const float du = static_cast<float>(camera.fx) * to_sun.x() / to_sun.z();
    const float dv = static_cast<float>(camera.fy) * to_sun.y() / to_sun.z();
    const float along[] = {-0.15F, -0.35F, -0.55F, 0.3F}, size[] = {0.02F, 0.045F, 0.03F, 0.012F};
    for (int i = 0; i < 4; ++i) {
      const Colour tint(i == 0 ? 0.5F : 0.3F, 0.35F, i == 1 ? 0.5F : 0.3F);
      add_disc(cx + along[i] * du, cy + along[i] * dv, size[i] * width,
               sun_colour.cwiseProduct(tint) * (0.6F * strength));
    }
  }
  RandomSequence random(seed);
  const int sparkles = static_cast<int>(80.0F * strength);
  for (int i = 0; i < sparkles; ++i) {
    const float u = random.uniform(0.0F, width), v = random.uniform(0.0F, height);
    const float bright = random.uniform(0.2F, 1.5F), radius = random.uniform(1.0F, 3.5F);
    add_disc(u, v, radius, Colour::Constant(bright));
  }
}

float automatic_exposure(const Image<Colour>& radiance, double time, float change, std::uint32_t seed) {
  constexpr int kStep = 4;  // every fourth pixel each way is enough for a mean
  constexpr float kMiddle = 0.32F, kStrength = 0.8F;
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < radiance.height(); row += kStep) {
    for (int column = 0; column < radiance.width(); column += kStep) {
      sum += std::min(static_cast<double>(radiance.at(column, row)[1]), 1.0);
      ++count;
    }
  }
  const auto mean = static_cast<float>(sum / count) + 1e-3F;
  const float hunting = 1.0F + change * value_noise(static_cast<float>(time) * 0.35F, 0.5F, seed);
  return std::pow(kMiddle / mean, kStrength) * hunting;
}

void develop_grey(const Image<Colour>& radiance, const SensorSettings& settings, ByteImage& grey) {
  grey.create(radiance.width(), radiance.height());
  parallel_for(radiance.height(), 8, [&](int row) {
    for (int column = 0; column < radiance.width(); ++column) {
      const Colour& light = radiance.at(column, row);
      const auto pixel = static_cast<std::uint32_t>(row * radiance.width() + column);
      const float noise =
          settings.noise * gaussian_noise(mix_bits(pixel * 0x9e3779b1U + settings.noise_seed));
      const float sum = 0.299F * light[0] + 0.587F * light[1] + 0.114F * light[2];
      grey.at(column, row) = level(sum * settings.exposure, noise);
    }
  });
}

void develop_bgr(const Image<Colour>& radiance, const SensorSettings& settings, ByteImage& bgr) {
  bgr.create(radiance.width(), radiance.height(), 3);
  parallel_for(radiance.height(), 8, [&](int row) {
    for (int column = 0; column < radiance.width(); ++column) {
      const Colour& light = radiance.at(column, row);
      const auto pixel = static_cast<std::uint32_t>(row * radiance.width() + column);
      for (int channel = 0; channel < 3; ++channel) {
        const std::uint32_t h = mix_bits(pixel * 0x9e3779b1U + settings.noise_seed +
                                         static_cast<std::uint32_t>(channel) * 0x632be5abU);
        bgr.at(column, row, 2 - channel) =
            level(light[channel] * settings.exposure, settings.noise * gaussian_noise(h));
      }
    }
  });
}

}  // namespace penumbra::slam::synthetic
