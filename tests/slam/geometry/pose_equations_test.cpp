#include "slam/geometry/pose_equations.h"

#include <gtest/gtest.h>

#include <random>

namespace penumbra::slam {
namespace {

// The products as they stand, of what a point at `p` measures.
TEST(PoseEquations, AreTheProductsOfTheJacobian) {
  StereoCamera camera;
  camera.fx = 718.0;
  camera.fy = 715.0;
  camera.cx = 607.0;
  camera.cy = 185.0;
  camera.baseline = 0.54;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-3.0, 3.0);
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d p(number(random), number(random), 8.0 + number(random));
    if (i % 10 == 0) p = {0.0, 0.0, i % 20 == 0 ? 0.05 : 1e4};
    const bool stereo = i % 3 != 0;
    const double weight = i % 7 == 0 ? 0.0 : 4.0 + number(random);
    const Eigen::Vector3d e(number(random), number(random), stereo ? number(random) : 0.0);
    const Eigen::Matrix3d J_pi = projection_jacobian(camera, p, stereo);
    const Eigen::Matrix3d R = so3_exp({number(random), number(random), number(random)});
    const Eigen::Matrix3d J_point = J_pi * R;
    const Eigen::Matrix<double, 3, 6> J = pose_jacobian(J_pi, p);

    Matrix6d H = Matrix6d::Constant(number(random)), lower_H = H, naive_H = H;
    Vector6d g = Vector6d::Constant(number(random)), naive_g = g;
    naive_H += weight * J.transpose() * J;
    naive_g += weight * J.transpose() * e;
    const Eigen::Matrix<double, 6, 3> naive_W = weight * J.transpose() * J_point;

    const PoseEquations equations(J_pi, p, weight);
    equations.add_upper_hessian(H.data());
    equations.add_lower_hessian(lower_H.data());
    equations.add_gradient(e, g.data());
    const auto upper = [](const Matrix6d& M) { return Matrix6d(M.triangularView<Eigen::Upper>()); };
    EXPECT_LE((upper(H) - upper(naive_H)).norm(), 1e-12 * naive_H.norm()) << i;
    EXPECT_LE((upper(lower_H.transpose()) - upper(naive_H)).norm(), 1e-12 * naive_H.norm()) << i;
    EXPECT_LE((g - naive_g).norm(), 1e-12 * naive_g.norm()) << i;
    EXPECT_LE((equations.cross(J_point) - naive_W).norm(), 1e-12 * naive_W.norm()) << i;
    EXPECT_LE((equations.weighted_right_row() - weight * J.row(2).transpose()).norm(),
              1e-12 * weight * J.norm());
  }
}

}  // namespace
}  // namespace penumbra::slam
