#include "slam/map/point_uncertainty.h"

#include <cmath>
#include <limits>

#include "slam/map/keyframe.h"

namespace penumbra::slam {

double relative_distance_uncertainty(const MapPoint& point, const StereoCamera& camera,
                                     const std::vector<double>& scales) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  double distance = kUnknown;
  Eigen::Vector3d ray = Eigen::Vector3d::Zero();  // world
  for (const Observation& o : point.observations) {
    const Eigen::Vector3d from_camera = point.position - camera_centre(o.keyframe->T_cw);
    if (from_camera.norm() >= distance) continue;
    distance = from_camera.norm();
    ray = from_camera / distance;
  }
  double information = 0.0;  // 1 / metres^2
  for (const Observation& o : point.observations) {
    const SE3& T_cw = o.keyframe->T_cw;
    const Eigen::Vector3d p = T_cw * point.position;
    if (p.z() <= 0.0) return kUnknown;
    const PixelMeasurement z = measurement_of(o.keyframe->view(), o.feature, scales);
    information +=
        z.inverse_variance * (projection_jacobian(camera, p, z.stereo) * (T_cw.rotation * ray)).squaredNorm();
  }
  return information > 0.0 && distance > 0.0 ? 1.0 / (std::sqrt(information) * distance) : kUnknown;
}

}  // namespace penumbra::slam
