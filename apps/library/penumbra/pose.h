// Where a camera is: a rotation and a translation.
//
//   X_a = R X_b + t,   written T_ab           metres; camera frames: x right, y down, z ahead
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace penumbra {

struct Pose {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  // R, row by row
  std::array<double, 3> translation{0, 0, 0};                 // t, metres

  std::array<double, 3> operator*(const std::array<double, 3>& p) const {
    std::array<double, 3> moved = translation;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) moved[i] += rotation[3 * i + j] * p[j];
    }
    return moved;
  }
  Pose operator*(const Pose& other) const {
    Pose product;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) sum += rotation[3 * i + k] * other.rotation[3 * k + j];
        product.rotation[3 * i + j] = sum;
      }
    }
    product.translation = *this * other.translation;
    return product;
  }
  Pose inverse() const {
    Pose back;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) back.rotation[3 * i + j] = rotation[3 * j + i];
    }
    back.translation = {0, 0, 0};
    const std::array<double, 3> t = back * translation;
    back.translation = {-t[0], -t[1], -t[2]};
    return back;
  }
  // (x, y, z, w) of unit length, w >= 0, as ROS and TUM's files have it.
  std::array<double, 4> quaternion() const {
    const std::array<double, 9>& r = rotation;
    // The largest of the four squares is divided by: no digits are lost.
    const double squares[4] = {1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8], 1 - r[0] - r[4] + r[8],
                               1 + r[0] + r[4] + r[8]};
    std::size_t most = 3;
    for (std::size_t i = 0; i < 3; ++i) {
      if (squares[i] > squares[most]) most = i;
    }
    std::array<double, 4> q{};
    switch (most) {
      case 0:
        q = {squares[0], r[1] + r[3], r[2] + r[6], r[7] - r[5]};
        break;
      case 1:
        q = {r[1] + r[3], squares[1], r[5] + r[7], r[2] - r[6]};
        break;
      case 2:
        q = {r[2] + r[6], r[5] + r[7], squares[2], r[3] - r[1]};
        break;
      default:
        q = {r[7] - r[5], r[2] - r[6], r[3] - r[1], squares[3]};
    }
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double sign = q[3] < 0 ? -1.0 / length : 1.0 / length;
    for (double& value : q) value *= sign;
    return q;
  }
};

struct TimedPose {
  double timestamp = 0.0;  // seconds
  Pose T_world_camera = {};
};

}  // namespace penumbra
