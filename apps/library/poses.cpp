#include "apps/library/poses.h"

#include <fmt/core.h>

#include "nn/base/error.h"

namespace penumbra {

Pose pose_of(const slam::SE3& T) {
  Pose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      pose.rotation[static_cast<std::size_t>(3 * row + column)] = T.rotation(row, column);
    pose.translation[static_cast<std::size_t>(row)] = T.translation(row);
  }
  return pose;
}

slam::SE3 motion_of(const Pose& pose, const char* place) {
  slam::SE3 T;
  T.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data());
  T.translation = Eigen::Map<const Eigen::Vector3d>(pose.translation.data());
  const double error = (T.rotation * T.rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!T.is_finite() || !(error < 1e-3) || T.rotation.determinant() < 0.0) {
    throw InputError(place, "a rotation and a translation",
                     fmt::format("a matrix that is off a rotation by {:.3g}", error));
  }
  T.normalize();
  return T;
}

}  // namespace penumbra
