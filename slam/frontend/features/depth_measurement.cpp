#include "slam/frontend/features/depth_measurement.h"

#include <cmath>
#include <limits>

namespace penumbra::slam {

namespace {

// Metres; NaN where it is unknown.
float depth_at(const FloatImage& depth, double u, double v) {
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  if (!(u > -0.5 && v > -0.5 && u < depth.width() - 0.5 && v < depth.height() - 0.5)) return unknown;
  const float z = depth.at(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
  return z > 0.0F && std::isfinite(z) ? z : unknown;
}

// Depth along the feature's ray, of a depth image that was taken from elsewhere.
float depth_from(const StereoCamera& camera, const Keypoint& feature, const FloatImage& depth,
                 const SE3& T_dc) {
  constexpr float kTypicalDepth = 2.0F;  // metres
  constexpr int kRounds = 2;
  float z = depth_at(depth, feature.u, feature.v);
  if (std::isnan(z)) z = kTypicalDepth;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d there = T_dc * camera.back_project(feature.u, feature.v, z);
    if (!(there.z() > 0.0)) return std::numeric_limits<float>::quiet_NaN();
    const Eigen::Vector3d pixel = camera.project_stereo(there);
    const float seen = depth_at(depth, pixel.x(), pixel.y());
    if (std::isnan(seen)) return seen;
    z = static_cast<float>((T_dc.inverse() * camera.back_project(pixel.x(), pixel.y(), seen)).z());
  }
  return z;
}

}  // namespace

void measure_depth(const StereoCamera& camera, const Features& features, const FloatImage& depth,
                   StereoMatches& matches, const SE3& T_dc) {
  const std::size_t n = features.keypoints.size();
  matches.u_right.assign(n, -1.0F);
  matches.depth.assign(n, -1.0F);
  matches.count = 0;
  const float fx_baseline = static_cast<float>(camera.fx * camera.baseline);
  const bool at_once = T_dc.rotation.isIdentity(0.0) && T_dc.translation.isZero(0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const Keypoint& k = features.keypoints[i];
    const float z = at_once ? depth_at(depth, k.u, k.v) : depth_from(camera, k, depth, T_dc);
    if (!(z > 0.0F)) continue;
    const float u_right = k.u - fx_baseline / z;
    if (u_right < 0.0F) continue;
    matches.u_right[i] = u_right;
    matches.depth[i] = z;
    ++matches.count;
  }
}

}  // namespace penumbra::slam
