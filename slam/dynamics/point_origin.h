// Where and when a feature's point was first seen: what its later places are compared with.
#pragma once

#include <vector>

#include "slam/dynamics/object_motion.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

struct PointOrigin {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // odometry's frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double time = 0.0;
  bool known = false;
};

// Of a feature of a frame at `time`, `T_co` (camera from odometry): where its stereo depth has it; not known
// without. `scales`: level_scales of the pyramid.
PointOrigin point_origin(const StereoCamera& camera, const std::vector<double>& scales,
                         const FeatureView& features, int feature, const SE3& T_co, double time,
                         const ObjectMotionSettings& settings);

}  // namespace penumbra::slam
