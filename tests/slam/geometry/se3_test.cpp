#include "slam/geometry/se3.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace penumbra::slam {
namespace {

Vector6d random_twist(std::mt19937& random, double angle) {
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = normal(random);
  xi.tail<3>() *= angle / xi.tail<3>().norm();
  return xi;
}

TEST(SE3, LogInvertsExpAtEveryAngle) {
  std::mt19937 random(1);
  for (const double angle : {0.0, 1e-12, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 3.0, std::numbers::pi - 1e-6}) {
    const Vector6d xi = random_twist(random, angle);
    EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-8) << "angle " << angle;
  }
}

TEST(SE3, ExpMatchesThePowerSeries) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector6d xi = random_twist(random, 0.5);
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
    generator.topLeftCorner<3, 3>() = skew(xi.tail<3>());
    generator.topRightCorner<3, 1>() = xi.head<3>();
    Eigen::Matrix4d term = Eigen::Matrix4d::Identity(), sum = term;
    for (int n = 1; n < 30; ++n) sum += term = term * generator / n;
    const SE3 pose = SE3::exp(xi);
    EXPECT_LT((pose.rotation - sum.topLeftCorner<3, 3>()).norm(), 1e-12);
    EXPECT_LT((pose.translation - sum.topRightCorner<3, 1>()).norm(), 1e-12);
  }
}

TEST(SE3, InverseAndProductAgreeOnPoints) {
  std::mt19937 random(3);
  const SE3 a = SE3::exp(random_twist(random, 1.2)), b = SE3::exp(random_twist(random, 2.1));
  const Eigen::Vector3d p(1.0, -2.0, 3.0);
  EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
  EXPECT_LT(((a * a.inverse()) * p - p).norm(), 1e-12);
}

TEST(SE3, NormalizeRestoresTheRotation) {
  std::mt19937 random(4);
  SE3 pose = SE3::exp(random_twist(random, 0.7));
  pose.rotation *= 1.0 + 1e-4;
  pose.normalize();
  EXPECT_LT((pose.rotation * pose.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(SE3, TheAdjointCarriesAMotionThroughAPose) {
  std::mt19937 random(5);
  const SE3 T = SE3::exp(random_twist(random, 1.0));
  const Vector6d xi = random_twist(random, 0.7);
  const SE3 carried = T * SE3::exp(xi) * T.inverse(), expected = SE3::exp(adjoint(T) * xi);
  EXPECT_LT((carried.rotation - expected.rotation).norm(), 1e-12);
  EXPECT_LT((carried.translation - expected.translation).norm(), 1e-12);
}

TEST(SE3, TheInverseLeftJacobianIsTheDerivativeOfTheLogarithm) {
  std::mt19937 random(6);
  for (const double angle : {0.0, 1e-6, 0.01, 0.049, 0.051, 0.5, 1.5, 3.0}) {
    const Vector6d xi = random_twist(random, angle);
    const Matrix6d J_inverse = left_jacobian_inverse(xi);
    for (int c = 0; c < 6; ++c) {
      Vector6d step = Vector6d::Zero();
      step[c] = 1e-6;
      const Vector6d numeric =
          ((SE3::exp(step) * SE3::exp(xi)).log() - (SE3::exp(-step) * SE3::exp(xi)).log()) / 2e-6;
      EXPECT_LT((J_inverse.col(c) - numeric).norm(), 1e-7) << "angle " << angle << ", component " << c;
    }
  }
}

// Yaw turns the nose to the left, pitch then lowers it, roll then lowers the right side: of x ahead, y left,
// z up.
TEST(SE3, RollPitchAndYawTurnOneAfterTheOther) {
  const double quarter = std::acos(0.0);
  const auto nose = [&](double roll, double pitch, double yaw) {
    return Eigen::Vector3d(so3_from_roll_pitch_yaw(roll, pitch, yaw) * Eigen::Vector3d::UnitX());
  };
  EXPECT_LT((nose(0.0, 0.0, quarter) - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((nose(0.3, quarter, 0.7) + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((so3_from_roll_pitch_yaw(quarter, 0.0, 0.0) * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ())
                .norm(),
            1e-12);
  EXPECT_LT((so3_from_roll_pitch_yaw(0.1, -0.2, 0.3) -
             so3_exp({0.0, 0.0, 0.3}) * so3_exp({0.0, -0.2, 0.0}) * so3_exp({0.1, 0.0, 0.0}))
                .norm(),
            1e-12);
}

TEST(SE3, ProperInverseOfADriftedRotationIsAMotion) {
  constexpr double kDrift = 1e-7;
  const SE3 T{so3_exp({0.4, -0.2, 0.9}), {1.0, 2.0, 3.0}};
  const SE3 T_inverse = proper_inverse({(1.0 + kDrift) * T.rotation, T.translation});
  EXPECT_LT((T_inverse.rotation.transpose() * T_inverse.rotation - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
  EXPECT_LT((T_inverse.rotation * T.rotation - Eigen::Matrix3d::Identity()).norm(), kDrift);
  EXPECT_LT((T_inverse * T.translation).norm(), 1e-12);
}

}  // namespace
}  // namespace penumbra::slam
