#include "slam/dynamics/point_origin.h"

namespace penumbra::slam {

PointOrigin point_origin(const StereoCamera& camera, const std::vector<double>& scales,
                         const FeatureView& features, int feature, const SE3& T_co, double time,
                         const ObjectMotionSettings& settings) {
  PointOrigin origin;
  if (!features.has_stereo(feature)) return origin;
  const FeaturePixel pixel = features.pixel(feature);
  const SE3 T_oc = T_co.inverse();
  const double scale = scales[static_cast<std::size_t>(features.level(feature))];
  origin.position = T_oc * camera.back_project(pixel.u, pixel.v, features.depth(feature));
  origin.covariance = T_oc.rotation * stereo_covariance(camera, features, feature, scale, settings) *
                      T_oc.rotation.transpose();
  origin.time = time;
  origin.known = true;
  return origin;
}

}  // namespace penumbra::slam
