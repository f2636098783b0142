#include "slam/brain/motion/odometry_noise.h"

#include <cmath>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"

namespace penumbra::slam::brain {

namespace {

constexpr double kSlipSeconds = 0.5;

double standard_normal(std::uint64_t seed, std::uint64_t counter) {
  return normal_of(counter_uniform(seed, 2 * counter), counter_uniform(seed, 2 * counter + 1));
}

}  // namespace

OdometryNoise odometry_noise(std::string_view name) {
  if (name == "none") return {};
  if (name == "noisy") {
    return {.scale = 0.02,
            .gyro_bias = 0.0008,
            .white_speed = 0.02,
            .white_turn = 0.004,
            .slips = 0.5,
            .slip_share = 0.5,
            .turn_slip = 0.2};
  }
  if (name == "rough") {
    return {.scale = 0.05,
            .gyro_bias = 0.003,
            .white_speed = 0.05,
            .white_turn = 0.012,
            .slips = 2.0,
            .slip_share = 0.7,
            .turn_slip = 0.4};
  }
  throw UsageError(fmt::format("odometry noise: expected none, noisy or rough, found '{}'", name));
}

std::vector<SelfMotion> spoiled_odometry(const Trajectory& truth, const OdometryNoise& noise,
                                         std::uint64_t seed, const CameraMount& mount) {
  if (truth.size() < 2) {
    throw InputError("ground truth", "at least two poses to make odometry of",
                     fmt::format("{}", truth.size()));
  }
  std::vector<SelfMotion> motions(truth.size());
  double slip_left = 0.0;  // seconds
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double dt = truth[i].timestamp - truth[i - 1].timestamp;
    if (!(dt > 0.0)) {
      throw InputError(fmt::format("ground truth, pose {}", i), "a later time than the pose before",
                       fmt::format("{:+g} s", dt));
    }
    SelfMotion& motion = motions[i];
    motion = motion_of(plane_pose(mount.to_robot(truth[i - 1].T_wc.inverse() * truth[i].T_wc)), dt);
    const double speed = std::abs(motion.speed);
    const std::uint64_t draw = 4 * i;
    if (slip_left <= 0.0 && speed > 0.0 &&
        counter_uniform(seed ^ 0x51195119U, draw) < noise.slips * dt / 60.0)
      slip_left = kSlipSeconds;
    if (slip_left > 0.0) {
      motion.speed *= 1.0 + noise.slip_share;
      motion.turn_rate *= 1.0 - noise.turn_slip;
      slip_left -= dt;
    }
    motion.speed +=
        noise.scale * motion.speed + noise.white_speed * std::sqrt(speed / dt) * standard_normal(seed, draw);
    motion.turn_rate += noise.gyro_bias + noise.white_turn / std::sqrt(dt) * standard_normal(seed, draw + 1);
  }
  return motions;
}

}  // namespace penumbra::slam::brain
