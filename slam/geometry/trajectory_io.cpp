#include "slam/geometry/trajectory_io.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/geometry/pose_table.h"
#include "slam/geometry/time_unit.h"

namespace penumbra::slam {

namespace {

constexpr double kShortestQuaternion = 1e-6;

void require_rotation(const Eigen::Matrix3d& rotation, const std::string& place) {
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance)) {
    throw InputError(place, "a rotation matrix (R^T R = I)", fmt::format("R^T R off by {:.3g}", error));
  }
  if (rotation.determinant() < 0.0) throw InputError(place, "a rotation matrix (det = 1)", "a reflection");
}

// How a KITTI line of so many numbers is made up.
struct KittiColumns {
  std::size_t numbers;
  bool has_frame, has_last_row;
};
constexpr KittiColumns kKittiColumns[] = {
    {12, false, false}, {13, true, false}, {16, false, true}, {17, true, true}};

const KittiColumns& kitti_columns(const PoseTable& table) {
  const std::size_t count = table.lines.front().values.size();
  for (const KittiColumns& columns : kKittiColumns) {
    if (columns.numbers == count) return columns;
  }
  throw InputError(
      table.place(table.lines.front()),
      "a pose as 3 x 4 matrix rows (12 numbers; 16 with the last row, 13 or 17 with the frame's number)",
      counted(count, "number"));
}

void require_count(const PoseTable& table, const PoseLine& line, std::size_t count, std::string_view record) {
  if (line.values.size() == count) return;
  throw InputError(table.place(line), fmt::format("{} ({} numbers)", record, count),
                   counted(line.values.size(), "number"));
}

void say(Notes* notes, std::string note) {
  if (notes != nullptr) notes->push_back(std::move(note));
}

// How the table was read.
void say_all(Notes* notes, const PoseTable& table) {
  for (const std::string& note : table.notes) say(notes, note);
}

Trajectory read_matrices(const std::filesystem::path& path, Notes* notes) {
  const PoseTable table = read_pose_table(path);
  say_all(notes, table);
  const KittiColumns& columns = kitti_columns(table);
  Trajectory trajectory;
  for (const PoseLine& line : table.lines) {
    require_count(table, line, columns.numbers, "a pose as 3 x 4 matrix rows, as the first line is");
    const double* values = line.values.data() + (columns.has_frame ? 1 : 0);
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(values);
    const SE3 pose{matrix.leftCols<3>(), matrix.rightCols<1>()};
    require_rotation(pose.rotation, table.place(line));
    if (columns.has_last_row &&
        !(values[12] == 0.0 && values[13] == 0.0 && values[14] == 0.0 && values[15] == 1.0)) {
      throw InputError(table.place(line), "0 0 0 1 as the last row",
                       fmt::format("{:g} {:g} {:g} {:g}", values[12], values[13], values[14], values[15]));
    }
    double time = static_cast<double>(trajectory.size());
    if (columns.has_frame) {
      time = line.values.front();
      if (!line.first.whole || time < 0.0 || (!trajectory.empty() && !(time > trajectory.back().timestamp))) {
        throw InputError(table.place(line),
                         "the frame's number, above the one before, and 12 numbers of the pose",
                         fmt::format("{:.6f}", time));
      }
    }
    trajectory.push_back({time, pose});
  }
  return trajectory;
}

// Where the parts of a pose stand in a line.
struct QuaternionColumns {
  std::size_t position, x, w;  // of y and z: after x
};

SE3 read_pose(const PoseTable& table, const PoseLine& line, const QuaternionColumns& at,
              std::size_t& unequal) {
  const std::vector<double>& v = line.values;
  const Eigen::Quaterniond q(v[at.w], v[at.x], v[at.x + 1], v[at.x + 2]);
  const double length = q.norm();
  if (!(length > kShortestQuaternion && std::isfinite(length))) {
    throw InputError(table.place(line), "a quaternion", fmt::format("one of length {:g}", length));
  }
  if (std::abs(length - 1.0) > kRotationTolerance) ++unequal;
  return {q.normalized().toRotationMatrix(), {v[at.position], v[at.position + 1], v[at.position + 2]}};
}

void say_unequal(Notes* notes, const std::string& path, std::size_t unequal, std::size_t count) {
  if (unequal == 0) return;
  say(notes, fmt::format("{}: not of length 1: {} of {}; all are divided by their length", path, unequal,
                         counted(count, "quaternion")));
}

constexpr QuaternionColumns kScalarLast{1, 4, 7}, kScalarFirst{1, 5, 4};

void require_times(const PoseTable& table) {
  if (table.is_named && table.lines.front().values.size() < 8)
    throw InputError(table.path, "a column of times", "none among the names of the columns");
}

Trajectory read_timed(const PoseTable& table, TimeRule rule, const QuaternionColumns& at, Notes* notes) {
  if (table.unit) rule.documented = table.unit;
  Notes unit;
  std::vector<FileTime> times;
  for (const PoseLine& line : table.lines) times.push_back(line.first);
  const std::vector<double> seconds = to_seconds(times, rule, table.path, unit);
  for (std::string& note : unit) say(notes, std::move(note));
  Trajectory trajectory;
  std::size_t unequal = 0, backwards = 0;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    if (i > 0 && seconds[i] < seconds[i - 1]) ++backwards;
    trajectory.push_back({seconds[i], read_pose(table, table.lines[i], at, unequal)});
  }
  say_unequal(notes, table.path, unequal, trajectory.size());
  if (backwards > 0) {
    std::stable_sort(trajectory.begin(), trajectory.end(),
                     [](const TimedPose& a, const TimedPose& b) { return a.timestamp < b.timestamp; });
    say(notes, fmt::format("{}: time goes back in {}; the poses are sorted by time", table.path,
                           counted(backwards, "line")));
  }
  return trajectory;
}

}  // namespace

std::vector<SE3> read_kitti_poses(const std::filesystem::path& path) {
  std::vector<SE3> poses;
  for (const TimedPose& pose : read_matrices(path, nullptr)) poses.push_back(pose.T_wc);
  return poses;
}

Trajectory read_kitti_trajectory(const std::filesystem::path& path, Notes* notes) {
  return read_matrices(path, notes);
}

Trajectory read_tum_trajectory(const std::filesystem::path& path, Notes* notes) {
  const PoseTable table = read_pose_table(path);
  require_times(table);
  for (const PoseLine& line : table.lines) require_count(table, line, 8, "a pose 't tx ty tz qx qy qz qw'");
  say_all(notes, table);
  const bool w_first = table.w_first.value_or(false);
  if (w_first)
    say(notes, fmt::format("{}: the quaternions are taken as qw qx qy qz, as the header says", table.path));
  return read_timed(table, kPoseSeconds, w_first && !table.is_named ? kScalarFirst : kScalarLast, notes);
}

Trajectory read_euroc_trajectory(const std::filesystem::path& path, Notes* notes) {
  const PoseTable table = read_pose_table(path);
  require_times(table);
  for (const PoseLine& line : table.lines) {
    if (line.values.size() >= 8) continue;
    throw InputError(table.place(line), "at least 8 numbers: NANOSECONDS,x,y,z,qw,qx,qy,qz,...",
                     fmt::format("{}", line.values.size()));
  }
  say_all(notes, table);
  const bool w_first = table.w_first.value_or(true);
  if (!table.w_first) {
    say(notes,
        fmt::format("{}: no header names the columns; taken as EuRoC's t x y z qw qx qy qz", table.path));
  }
  if (!w_first)
    say(notes, fmt::format("{}: the quaternions are taken as qx qy qz qw, as the header says", table.path));
  return read_timed(table, kPoseNanoseconds, w_first && !table.is_named ? kScalarFirst : kScalarLast, notes);
}

Trajectory read_tartanair_trajectory(const std::filesystem::path& path, Notes* notes) {
  const PoseTable table = read_pose_table(path);
  Trajectory trajectory;
  std::size_t unequal = 0;
  for (const PoseLine& line : table.lines) {
    require_count(table, line, 7, "a pose 'tx ty tz qx qy qz qw'");
    trajectory.push_back(
        {static_cast<double>(trajectory.size()), read_pose(table, line, {0, 3, 6}, unequal)});
  }
  say_all(notes, table);
  say_unequal(notes, table.path, unequal, trajectory.size());
  return trajectory;
}

const char* to_string(TrajectoryFormat format) {
  static constexpr const char* kNames[] = {"kitti", "tum", "euroc", "tartanair"};
  return kNames[static_cast<std::size_t>(format)];
}

bool has_times(TrajectoryFormat format) {
  return format == TrajectoryFormat::tum || format == TrajectoryFormat::euroc;
}

Trajectory read_trajectory(const std::filesystem::path& path, TrajectoryFormat format, Notes* notes) {
  switch (format) {
    case TrajectoryFormat::kitti:
      return read_kitti_trajectory(path, notes);
    case TrajectoryFormat::tum:
      return read_tum_trajectory(path, notes);
    case TrajectoryFormat::euroc:
      return read_euroc_trajectory(path, notes);
    case TrajectoryFormat::tartanair:
      break;
  }
  Trajectory trajectory = read_tartanair_trajectory(path, notes);
  say(notes,
      fmt::format(
          "{}: 7 numbers a line are taken as TartanAir's tx ty tz qx qy qz qw without times, its axes "
          "(x forward, y right, z down) as they are: RPE and drift compare only with poses of the same axes",
          path.string()));
  return trajectory;
}

TrajectoryFormat detect_trajectory_format(const std::filesystem::path& path) {
  const PoseTable table = read_pose_table(path);
  const std::size_t count = table.lines.front().values.size();
  if (table.is_named && count == 7) return TrajectoryFormat::tartanair;
  if (table.is_named) return table.has_commas ? TrajectoryFormat::euroc : TrajectoryFormat::tum;
  if (count == 12 || (!table.has_commas && (count == 13 || count == 16 || count == 17)))
    return TrajectoryFormat::kitti;
  if (table.has_commas && count >= 8) return TrajectoryFormat::euroc;
  if (count == 8) return TrajectoryFormat::tum;
  if (count == 7) return TrajectoryFormat::tartanair;
  throw InputError(
      table.place(table.lines.front()),
      "12 numbers (KITTI; 16 with the last row, 13 or 17 with the frame's number), 8 (TUM), 8 or more "
      "between commas (EuRoC) or 7 (TartanAir)",
      counted(count, "number"));
}

}  // namespace penumbra::slam
