// How well the distance of a map point is known, from the directions that it was seen in.
//
// Along the unit vector r from the nearest camera to the point X, measurement k of X tells of the distance
//
//   I = sum_k |J_pi(T_k X) R_k r|^2 / sigma_k^2,      sigma_distance = 1 / sqrt(I)
//
// with J_pi of slam/geometry/reprojection.h and sigma_k a corner's (slam/frontend/features/measurement.h):
// what aligned patches measure better is less than what a calibration is usually wrong by. For one stereo
// pair that looks straight at the point this is the stereo formula sigma_Z = Z^2 sigma_d / (fx b). Cost: 20
// ns a measurement.
//
// A point whose distance has a standard deviation of more than half the distance is mostly uncertainty:
// "somewhere beyond", such as a cloud at half a pixel of disparity, which the map places kilometres away. It
// helps to hold the camera's rotation, but it is no place in a point cloud.
#pragma once

#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map_point.h"

namespace penumbra::slam {

// sigma_distance / distance; infinite where nothing tells (no measurement, or a point behind a camera).
double relative_distance_uncertainty(const MapPoint& point, const StereoCamera& camera,
                                     const std::vector<double>& scales);

inline constexpr double kMostRelativeUncertainty = 0.5;

inline bool is_mostly_uncertain(const MapPoint& point, const StereoCamera& camera,
                                const std::vector<double>& scales) {
  return relative_distance_uncertainty(point, camera, scales) > kMostRelativeUncertainty;
}

}  // namespace penumbra::slam
