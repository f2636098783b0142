#include "slam/world/hand_held_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nn/base/error.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Four sines between 1 and 7 Hz whose sum has about unit amplitude.
double tremor(double time, std::uint32_t seed) {
  RandomSequence random(seed);
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double frequency = random.uniform(0.8F, 1.2F) * (1.0 + 1.8 * i);
    sum += std::sin(kTwoPi * frequency * time + static_cast<double>(random.uniform(0.0F, 6.2831F))) /
           (1.0 + 0.8 * i);
  }
  return 0.5 * sum;
}

// Slow wandering, about -1..1.
double wander(double time, double period, std::uint32_t seed) {
  RandomSequence random(seed);
  const double a = static_cast<double>(random.uniform(0.0F, 6.2831F)),
               b = static_cast<double>(random.uniform(0.0F, 6.2831F));
  return 0.6 * (std::sin(kTwoPi * time / period + a) - std::sin(a)) +
         0.4 * (std::sin(kTwoPi * 1.7 * time / period + b) - std::sin(b));
}

// To and fro once within 0..1: out to 1, back, out to -1, back; at rest at both ends.
double to_and_fro(double t) {
  const double fade = std::sin(std::numbers::pi * t);
  return 1.54 * std::sin(kTwoPi * t) * fade * fade;
}

// Which of three axes has its turn at `time`, and how far out it is.
double turn_of(int axis, double time, double seconds, std::uint32_t seed) {
  const double turn = time / seconds;
  const int number = static_cast<int>(std::floor(turn));
  if (number % 3 != axis) return 0.0;
  const std::uint32_t h = hash_of(seed, static_cast<std::uint32_t>(number), 0x70aU);
  const double size = 0.85 + 0.3 * static_cast<double>(to_unit(h));
  return size * ((h & 1U) != 0U ? 1.0 : -1.0) * to_and_fro(turn - number);
}

SE3 pose_of(const HandHeldPath& path, double time, double share) {
  const SE3 held = looking_at(path.stand, path.target);
  const auto slow = [&](std::uint32_t channel, double period) {
    return wander(time, period, hash_of(path.seed, channel, 0x51U));
  };
  SE3 pose = held;
  if (path.kind == "xyz") {
    const double reach[] = {0.40, 0.25, 0.30};
    for (int axis = 0; axis < 3; ++axis) {
      pose.translation += held.rotation.col(axis) * (reach[axis] * turn_of(axis, time, 3.2, path.seed));
    }
    pose.rotation = pose.rotation * so3_exp({0.03 * slow(1, 5.0), 0.04 * slow(2, 6.0), 0.02 * slow(3, 5.0)});
  } else if (path.kind == "rpy") {
    Eigen::Vector3d angles;
    const double reach[] = {0.36, 0.50, 0.50};  // pitch, yaw, roll
    for (int axis = 0; axis < 3; ++axis) angles[axis] = reach[axis] * turn_of(axis, time, 3.6, path.seed);
    pose.rotation = pose.rotation * so3_exp(angles);
    pose.translation += 0.03 * Eigen::Vector3d(slow(1, 4.0), slow(2, 4.5), slow(3, 5.0));
  } else if (path.kind == "halfsphere") {
    const double azimuth = 1.15 * slow(1, 7.0), height = 0.35 + 0.40 * slow(2, 5.0);
    const Eigen::Vector3d centre = path.stand + 0.5 * held.rotation.col(2);
    const Eigen::Vector3d out =
        held.rotation * Eigen::Vector3d(std::sin(azimuth) * std::cos(height), -std::sin(height),
                                        -std::cos(azimuth) * std::cos(height));
    pose =
        looking_at(centre + 0.5 * out, path.target + 0.1 * Eigen::Vector3d(slow(3, 6.0), slow(4, 5.0), 0.0));
  } else if (path.kind == "desk") {
    const double angle = 1.0 * slow(1, 16.0), distance = 1.5 + 0.2 * slow(2, 9.0);
    const Eigen::Vector3d from =
        path.target +
        Eigen::Vector3d(distance * std::sin(angle), -0.55 - 0.2 * slow(3, 7.0), -distance * std::cos(angle));
    pose = looking_at(from, path.target + Eigen::Vector3d(0.35 * slow(4, 8.0), 0.05 * slow(5, 6.0), 0.0));
  } else if (path.kind == "twolaps") {
    const double angle = 2.0 * kTwoPi * share;
    // Every term has a whole number of periods, so that the end is the beginning.
    const Eigen::Vector3d from(path.laps.x() * std::sin(angle), path.stand.y() + 0.08 * std::sin(3.0 * angle),
                               -path.laps.y() * std::cos(angle));
    pose = looking_at(from, {0.3 * std::sin(2.0 * angle), path.target.y(), 0.2 * std::sin(angle)});
  } else {  // still
    pose.translation += 0.008 * Eigen::Vector3d(slow(1, 9.0), slow(2, 7.0), slow(3, 8.0));
    pose.rotation =
        pose.rotation * so3_exp(0.008 * Eigen::Vector3d(slow(4, 6.0), slow(5, 8.0), slow(6, 7.0)));
  }
  const double hand = path.kind == "twolaps" ? std::min(1.0, 8.0 * std::min(share, 1.0 - share)) : 1.0;
  const auto shake = [&](std::uint32_t channel) {
    return hand * tremor(time, hash_of(path.seed, channel, 0x7eeU));
  };
  pose.rotation = pose.rotation * so3_exp(0.0018 * Eigen::Vector3d(shake(1), shake(2), shake(3)));
  pose.translation += 0.0015 * Eigen::Vector3d(shake(4), shake(5), shake(6));
  return pose;
}

}  // namespace

SE3 looking_at(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d ahead = (to - from).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(ahead).normalized();
  SE3 pose;
  pose.rotation.col(0) = right;
  pose.rotation.col(1) = ahead.cross(right);
  pose.rotation.col(2) = ahead;
  pose.translation = from;
  return pose;
}

Trajectory hand_held_trajectory(const HandHeldPath& path, int frames) {
  static const char* const kKinds[] = {"still", "xyz", "rpy", "halfsphere", "desk", "twolaps"};
  if (std::find(std::begin(kKinds), std::end(kKinds), path.kind) == std::end(kKinds)) {
    throw UsageError(fmt::format(
        "--path: expected still, xyz, rpy, halfsphere, desk, twolaps or a file of poses, found '{}'",
        path.kind));
  }
  Trajectory poses(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) {
    const double time = i / path.rate;
    poses[static_cast<std::size_t>(i)] = {time, pose_of(path, time, frames > 1 ? i / (frames - 1.0) : 0.0)};
  }
  return poses;
}

Trajectory recorded_trajectory(const std::filesystem::path& file, const SE3& first, double rate, int frames) {
  const Trajectory recorded = read_tum_trajectory(file);
  const SE3 moved = first * recorded.front().T_wc.inverse();
  const double begin = recorded.front().timestamp, length = recorded.back().timestamp - begin;
  const int all = static_cast<int>(std::floor(length * rate + 1e-6)) + 1;
  if (frames > all) {
    throw UsageError(
        fmt::format("--frames: {} has {} at {} a second, fewer than {}", file.string(), all, rate, frames));
  }
  Trajectory poses;
  std::size_t k = 0;
  for (int i = 0; i < (frames == 0 ? all : frames); ++i) {
    const double time = i / rate;
    while (k + 2 < recorded.size() && recorded[k + 1].timestamp - begin <= time) ++k;
    SE3 pose = recorded[k].T_wc;
    if (k + 1 < recorded.size()) {
      const double step = recorded[k + 1].timestamp - recorded[k].timestamp;
      const double share =
          step > 0.0 ? std::clamp((time - (recorded[k].timestamp - begin)) / step, 0.0, 1.0) : 0.0;
      pose = pose * SE3::exp(share * (pose.inverse() * recorded[k + 1].T_wc).log());
    }
    poses.push_back({time, moved * pose});
  }
  return poses;
}

}  // namespace penumbra::slam::synthetic
