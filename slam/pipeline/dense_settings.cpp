#include "slam/pipeline/dense_settings.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam {

namespace {

// The nearest of 1, 2 and 5 times powers of ten.
double round_number(double x) {
  const double ten = std::pow(10.0, std::floor(std::log10(x)));
  const double share = x / ten;
  return ten * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
}

// How much smaller a pair is matched.
int shrink_of(const StereoCamera& camera) {
  constexpr double kMatched = 29'000.0;  // pixels
  constexpr int kMost = 4;
  const double pixels = static_cast<double>(camera.width) * camera.height;
  return std::clamp(static_cast<int>(std::lround(std::sqrt(pixels / kMatched))), 1, kMost);
}

template <class T>
void set_where_0(T& number, T value) {
  if (number == T{}) number = value;
}

void derive_rgbd(DenseSettings& s) {
  const OccupancySettings plan;
  const FusionSettings fusion;
  set_where_0(s.plan.cell, plan.cell);
  set_where_0(s.plan.lowest, plan.lowest);
  set_where_0(s.fusion.voxel, fusion.voxel);
  set_where_0(s.fusion.depth_noise, fusion.depth_noise);
  set_where_0(s.fusion.farthest, fusion.farthest);
  set_where_0(s.fusion.fewest_views, fusion.fewest_views);
  set_where_0(s.least_metres, 0.05);
}

void derive_stereo(DenseSettings& s, const StereoCamera& camera) {
  constexpr double kBaselines = 24.0, kSigmaCells = 2.0;
  set_where_0(s.fusion.depth_noise, s.stereo.noise * s.stereo.shrink / (camera.fx * camera.baseline));
  const double reach = kBaselines * camera.baseline;
  set_where_0(s.plan.cell, round_number(s.fusion.depth_noise * reach * reach / kSigmaCells));
  set_where_0(s.plan.lowest, std::max(0.1, 1.5 * s.plan.cell));
  set_where_0(s.fusion.voxel, 0.5 * s.plan.cell);
  set_where_0(s.fusion.farthest, std::sqrt(kSigmaCells * s.plan.cell / s.fusion.depth_noise));
  set_where_0(s.fusion.fewest_views, 2);
  set_where_0(s.least_metres, s.plan.cell);
}

}  // namespace

DenseSettings with_derived(DenseSettings settings, Sensor sensor, const StereoCamera& camera) {
  set_where_0(settings.stereo.shrink, shrink_of(camera));
  if (sensor == Sensor::rgbd) {
    derive_rgbd(settings);
  } else {
    derive_stereo(settings, camera);
  }
  return settings;
}

}  // namespace penumbra::slam
