#include "slam/geometry/trajectory_io.h"

#include <cmath>
#include <iterator>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "nn/io/number_file.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kKittiRecord = "a pose as 3 x 4 matrix rows";
constexpr std::string_view kTumRecord = "a pose 't tx ty tz qx qy qz qw'";

std::string place_of(const std::filesystem::path& path, int line) {
  return fmt::format("{}:{}", path.string(), line);
}

void require_rotation(const Eigen::Matrix3d& rotation, const std::string& place) {
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance)) {
    throw InputError(place, "a rotation matrix (R^T R = I)", fmt::format("R^T R off by {:.3g}", error));
  }
  if (rotation.determinant() < 0.0) throw InputError(place, "a rotation matrix (det = 1)", "a reflection");
}

void require_poses(std::size_t count, const std::filesystem::path& path) {
  if (count == 0) throw InputError(path.string(), "at least one pose", "none");
}

void append_kitti_row(std::string& text, const SE3& pose) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double value = column < 3 ? pose.rotation(row, column) : pose.translation[row];
      fmt::format_to(std::back_inserter(text), "{}{:.17g}", row + column == 0 ? "" : " ", value);
    }
  }
  text += '\n';
}

}  // namespace

std::vector<SE3> read_kitti_poses(const std::filesystem::path& path) {
  std::vector<SE3> poses;
  for (const nn::NumberLine& record : nn::read_number_file(path, 12, kKittiRecord)) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(record.values.data());
    const SE3 pose{matrix.leftCols<3>(), matrix.rightCols<1>()};
    require_rotation(pose.rotation, place_of(path, record.line));
    poses.push_back(pose);
  }
  require_poses(poses.size(), path);
  return poses;
}

Trajectory read_kitti_trajectory(const std::filesystem::path& path) {
  Trajectory trajectory;
  for (const SE3& pose : read_kitti_poses(path)) {
    trajectory.push_back({static_cast<double>(trajectory.size()), pose});
  }
  return trajectory;
}

void write_kitti_poses(const std::filesystem::path& path, const std::vector<SE3>& poses) {
  std::string text;
  for (const SE3& pose : poses) append_kitti_row(text, pose);
  nn::write_file(path, text);
}

void write_kitti_poses(const std::filesystem::path& path, const Trajectory& trajectory) {
  std::string text;
  for (const TimedPose& pose : trajectory) append_kitti_row(text, pose.T_wc);
  nn::write_file(path, text);
}

Trajectory read_tum_trajectory(const std::filesystem::path& path) {
  Trajectory trajectory;
  for (const nn::NumberLine& record : nn::read_number_file(path, 8, kTumRecord)) {
    const std::vector<double>& v = record.values;
    const std::string place = place_of(path, record.line);
    const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    if (!(std::abs(q.norm() - 1.0) <= kRotationTolerance)) {
      throw InputError(place, "a unit quaternion", fmt::format("one of length {:.6g}", q.norm()));
    }
    if (!trajectory.empty() && v[0] < trajectory.back().timestamp) {
      throw InputError(place, fmt::format("a time of {:.6f} s or later", trajectory.back().timestamp),
                       fmt::format("{:.6f} s", v[0]));
    }
    trajectory.push_back({v[0], {q.normalized().toRotationMatrix(), {v[1], v[2], v[3]}}});
  }
  require_poses(trajectory.size(), path);
  return trajectory;
}

void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const TimedPose& pose : trajectory) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(pose.T_wc.rotation).normalized();
    const Eigen::Vector3d& t = pose.T_wc.translation;
    fmt::format_to(std::back_inserter(text),
                   "{:.9f} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", pose.timestamp, t.x(),
                   t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  nn::write_file(path, text);
}

const char* to_string(TrajectoryFormat format) { return format == TrajectoryFormat::kitti ? "kitti" : "tum"; }

Trajectory read_trajectory(const std::filesystem::path& path, TrajectoryFormat format) {
  return format == TrajectoryFormat::kitti ? read_kitti_trajectory(path) : read_tum_trajectory(path);
}

TrajectoryFormat detect_trajectory_format(const std::filesystem::path& path) {
  nn::NumberFileReader reader(path, "a pose");
  const std::optional<nn::NumberLine> first = reader.next();
  if (!first) throw InputError(path.string(), "at least one pose", "none");
  if (first->values.size() == 12) return TrajectoryFormat::kitti;
  if (first->values.size() == 8) return TrajectoryFormat::tum;
  throw InputError(reader.place(), "12 numbers (KITTI) or 8 numbers (TUM)",
                   fmt::format("{} numbers", first->values.size()));
}

}  // namespace penumbra::slam
