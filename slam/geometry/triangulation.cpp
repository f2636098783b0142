#include "slam/geometry/triangulation.h"

#include <Eigen/Dense>

namespace penumbra::slam {

namespace {

Eigen::Vector3d ray(const StereoCamera& camera, const View& view) {
  const Eigen::Vector3d in_camera = camera.back_project(view.pixel.x(), view.pixel.y(), 1.0);
  return view.T_cw.rotation.transpose() * in_camera;
}

Eigen::Matrix3d inverse_calibration(const StereoCamera& camera) {
  Eigen::Matrix3d K_inverse;
  K_inverse << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx,  //
      0.0, 1.0 / camera.fy, -camera.cy / camera.fy,           //
      0.0, 0.0, 1.0;
  return K_inverse;
}

// Reciprocal condition number of the normal equations below which the rays count as parallel.
constexpr double kParallel = 1e-12;

}  // namespace

std::optional<Eigen::Vector3d> triangulate(const StereoCamera& camera, std::span<const View> views) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const View& view : views) {
    const Eigen::Vector3d m = camera.back_project(view.pixel.x(), view.pixel.y(), 1.0);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d row = (m[i] * view.T_cw.rotation.row(2) - view.T_cw.rotation.row(i)).transpose();
      const double right = view.T_cw.translation[i] - m[i] * view.T_cw.translation.z();
      A += row * row.transpose();
      b += row * right;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
  if (!(eigen.eigenvalues()[0] > kParallel * eigen.eigenvalues()[2])) return std::nullopt;
  const Eigen::Vector3d X =
      eigen.eigenvectors() * (eigen.eigenvectors().transpose() * b).cwiseQuotient(eigen.eigenvalues());
  if (!X.allFinite()) return std::nullopt;
  for (const View& view : views) {
    if ((view.T_cw * X).z() <= 0.0) return std::nullopt;
  }
  return X;
}

double ray_cosine(const StereoCamera& camera, const View& a, const View& b) {
  return ray(camera, a).normalized().dot(ray(camera, b).normalized());
}

Eigen::Matrix3d fundamental_matrix(const StereoCamera& camera, const SE3& T_aw, const SE3& T_bw) {
  const SE3 T_ba = T_bw * T_aw.inverse();
  const Eigen::Matrix3d K_inverse = inverse_calibration(camera);
  return K_inverse.transpose() * skew(T_ba.translation) * T_ba.rotation * K_inverse;
}

}  // namespace penumbra::slam
