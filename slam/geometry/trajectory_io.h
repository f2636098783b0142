// Trajectory files in the two formats that every evaluation tool reads.
//
//   KITTI   r11 r12 r13 tx  r21 r22 r23 ty  r31 r32 r33 tz      the upper rows of T_wc; one line a frame
//   TUM     t tx ty tz qx qy qz qw                              seconds, T_wc, unit quaternion; '#' comments
//
// Readers throw InputError naming file and line: a wrong number of columns, something not a number, NaN, a
// matrix that is no rotation (an entry of R^T R off by more than kRotationTolerance, or det R < 0), a
// quaternion whose length is off by more than that, times that go back, no pose at all. KITTI
// rotations are kept exactly as read, rounding included (as evo does): re-orthonormalising would change the
// numbers that others compute from the same file. Quaternions are divided by their length (as evo does).
// Writers keep 17 digits, so that reading gives back the same doubles; they write under a temporary name
// first and throw Error where that fails.
//
// Sources: KITTI odometry development kit, readme; TUM RGB-D benchmark, "File Formats".
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

inline constexpr double kRotationTolerance = 1e-3;

// Poses T_wc, one per line. The second form gives pose i the time i, for KITTI files carry none.
std::vector<SE3> read_kitti_poses(const std::filesystem::path& path);
Trajectory read_kitti_trajectory(const std::filesystem::path& path);
void write_kitti_poses(const std::filesystem::path& path, const std::vector<SE3>& poses);
void write_kitti_poses(const std::filesystem::path& path, const Trajectory& trajectory);

Trajectory read_tum_trajectory(const std::filesystem::path& path);
void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory);

enum class TrajectoryFormat { kitti, tum };
const char* to_string(TrajectoryFormat format);
Trajectory read_trajectory(const std::filesystem::path& path, TrajectoryFormat format);
// By the number of columns in the first record: 12 or 8. Throws InputError for any other.
TrajectoryFormat detect_trajectory_format(const std::filesystem::path& path);

}  // namespace penumbra::slam
