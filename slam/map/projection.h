// Where a map point should be seen from a given pose.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "slam/frontend/features/frame_matcher.h"
#include "slam/frontend/features/level_of_size.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/map/map_point.h"

namespace penumbra::slam {

// The level on which a point with `reference_distance` is found from `distance`: a corner's size in the image
// falls with the distance,  level = log(reference_distance / distance) / log(s), unclamped.
inline int predicted_level(double reference_distance, double distance, const std::vector<double>& scales) {
  return static_cast<int>(std::lround(level_of_size(reference_distance / distance, level_step(scales))));
}

// Nothing where the point is behind the camera, out of the image, much nearer or farther than it was seen
// (more than one level outside the pyramid), or seen from a direction more than 60 degrees off.
inline std::optional<Projection> project_point(const StereoCamera& camera, const SE3& T_cw,
                                               const MapPoint& point, const std::vector<double>& scales) {
  constexpr double kCosLargestTurn = 0.5;
  const Eigen::Vector3d p = T_cw * point.position;
  if (!(p.z() > 0.0)) return std::nullopt;
  const Eigen::Vector3d pixel = camera.project_stereo(p);
  if (!camera.in_image(pixel.head<2>())) return std::nullopt;
  const double distance = p.norm();
  if ((T_cw.rotation * point.normal).dot(p) < kCosLargestTurn * distance) return std::nullopt;
  const int levels = static_cast<int>(scales.size());
  const int level = predicted_level(point.reference_distance, distance, scales);
  if (level < -1 || level > levels) return std::nullopt;
  Projection projection;
  projection.u = static_cast<float>(pixel.x());
  projection.v = static_cast<float>(pixel.y());
  projection.u_right = static_cast<float>(pixel.z());
  projection.level = std::clamp(level, 0, levels - 1);
  projection.descriptor = &point.descriptor;
  return projection;
}

}  // namespace penumbra::slam
