// Odometry as a wheeled robot has it, made of the true path: what the cognitive map must repair.
//
//   v     = (1 + scale) v_true + white_speed sqrt(|v_true| / dt) n_1           n: standard normal
//   omega = omega_true + gyro_bias + white_turn / sqrt(dt) n_2
//   with probability slips dt / 60 a slip begins: for half a second the wheels turn slip_share faster than
//   the robot drives, and turn_slip of the turn is not felt
//
// The white terms do not depend on the frame rate: the error of the way grows with its square root, that of
// the heading with the square root of time. Each number is a function of the seed and of the frame.
// Source of the form: Thrun, Burgard, Fox, Probabilistic Robotics (2005), section 5.3; the values of
// `noisy` are those of a cheap wheel encoder and MEMS gyroscope.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "slam/brain/motion/camera_mount.h"
#include "slam/brain/motion/self_motion.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam::brain {

struct OdometryNoise {
  double scale = 0.0;        // share of the speed
  double gyro_bias = 0.0;    // radians a second
  double white_speed = 0.0;  // metres per square root of a metre of way
  double white_turn = 0.0;   // radians per square root of a second
  double slips = 0.0;        // a minute
  double slip_share = 0.5, turn_slip = 0.3;
};

// "none", "noisy" or "rough"; throws UsageError for another name.
OdometryNoise odometry_noise(std::string_view name);

// Entry i: the motion of the robot from pose i - 1 to pose i of `truth`, which is its camera's; the first is
// at rest. Throws InputError where
// times do not increase or there are fewer than two poses.
std::vector<SelfMotion> spoiled_odometry(const Trajectory& truth, const OdometryNoise& noise,
                                         std::uint64_t seed, const CameraMount& mount = {});

}  // namespace penumbra::slam::brain
