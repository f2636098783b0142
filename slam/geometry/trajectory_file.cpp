#include "slam/geometry/trajectory_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <iterator>

namespace penumbra::slam {

namespace {

// -0 is 0 to every reader but a human one.
double without_sign_of_zero(double value) { return value == 0.0 ? 0.0 : value; }

void append_kitti_row(std::string& text, const SE3& pose) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double value = column < 3 ? pose.rotation(row, column) : pose.translation[row];
      fmt::format_to(std::back_inserter(text), "{}{:.17g}", row + column == 0 ? "" : " ",
                     without_sign_of_zero(value));
    }
  }
  text += '\n';
}

void append_tum_row(std::string& text, const TimedPose& pose) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(pose.T_wc.rotation).normalized();
  const Eigen::Vector3d& t = pose.T_wc.translation;
  fmt::format_to(std::back_inserter(text), "{:.9f}", pose.timestamp);
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
    fmt::format_to(std::back_inserter(text), " {:.17g}", without_sign_of_zero(value));
  text += '\n';
}

}  // namespace

TrajectoryFile::TrajectoryFile(const std::filesystem::path& path, TrajectoryFormat format)
    : format_(format), text_(path) {
  if (format_ == TrajectoryFormat::tum) text_.add("# timestamp tx ty tz qx qy qz qw\n");
}

void TrajectoryFile::add(const TimedPose& pose) {
  if (format_ == TrajectoryFormat::tum) {
    append_tum_row(text_.text(), pose);
  } else {
    append_kitti_row(text_.text(), pose.T_wc);
  }
  text_.flush_if_long();
}

void write_kitti_poses(const std::filesystem::path& path, const std::vector<SE3>& poses) {
  TrajectoryFile file(path, TrajectoryFormat::kitti);
  for (const SE3& pose : poses) file.add({0.0, pose});
  file.commit();
}

void write_kitti_poses(const std::filesystem::path& path, const Trajectory& trajectory) {
  TrajectoryFile file(path, TrajectoryFormat::kitti);
  for (const TimedPose& pose : trajectory) file.add(pose);
  file.commit();
}

void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory) {
  TrajectoryFile file(path, TrajectoryFormat::tum);
  for (const TimedPose& pose : trajectory) file.add(pose);
  file.commit();
}

}  // namespace penumbra::slam
