// Readers of numbers in text: records, calibration, trajectories.
#include <cmath>

#include "nn/base/number_file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/kitti_calibration.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

namespace {

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

void require_camera(const slam::StereoCamera& camera) {
  require(is_positive(camera.fx) && is_positive(camera.fy), "focal lengths are positive");
  require(std::isfinite(camera.cx) && std::isfinite(camera.cy), "the principal point is finite");
  require(is_positive(camera.baseline), "the baseline is positive");
}

void require_trajectory(const slam::Trajectory& trajectory) {
  require(!trajectory.empty(), "a trajectory has poses");
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const auto& [timestamp, T_wc] = trajectory[i];
    require(std::isfinite(timestamp), "times are finite");
    require(i == 0 || timestamp >= trajectory[i - 1].timestamp, "times do not go back");
    require(T_wc.translation.allFinite(), "positions are finite");
    const Eigen::Matrix3d& R = T_wc.rotation;
    const Eigen::Matrix3d error = R.transpose() * R - Eigen::Matrix3d::Identity();
    require((error.array().abs() <= slam::kRotationTolerance).all() && R.determinant() > 0.0,
            "rotations are rotations");
  }
}

}  // namespace

bool read_number_file(std::string_view bytes) {
  const MemoryFile file(bytes);
  is_read([&] { nn::read_number_file(file.path(), 3, "three numbers"); });
  return is_read([&] {
    nn::NumberFileReader reader(file.path(), "numbers");
    int last = 0;
    while (const std::optional<nn::NumberLine> record = reader.next()) {
      require(record->line > last, "lines are counted");
      last = record->line;
      require(!record->values.empty(), "a record has numbers");
      for (const double value : record->values) require(std::isfinite(value), "numbers are finite");
    }
  });
}

bool read_kitti_calibration(std::string_view bytes) {
  const MemoryFile file(bytes);
  const bool has_colour = is_read([&] { require_camera(slam::read_kitti_calibration(file.path(), 2, 3)); });
  return is_read([&] { require_camera(slam::read_kitti_calibration(file.path(), 0, 1)); }) || has_colour;
}

bool read_trajectory(std::string_view bytes) {
  const MemoryFile file(bytes);
  bool has_poses = false;
  is_read([&] { slam::detect_trajectory_format(file.path()); });
  for (const auto format :
       {slam::TrajectoryFormat::kitti, slam::TrajectoryFormat::tum, slam::TrajectoryFormat::tartanair}) {
    has_poses |= is_read([&] { require_trajectory(slam::read_trajectory(file.path(), format)); });
  }
  return has_poses;
}

bool read_euroc_ground_truth(std::string_view bytes) {
  const MemoryFile file(bytes);
  return is_read([&] { require_trajectory(slam::read_euroc_trajectory(file.path())); });
}

}  // namespace penumbra::fuzz
