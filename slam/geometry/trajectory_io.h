// Trajectory files in the formats that evaluation tools and data sets have.
//
//   KITTI      r11 r12 r13 tx  r21 r22 r23 ty  r31 r32 r33 tz    the upper rows of T_wc; one line a frame.
//                                                                With the last row 0 0 0 1: 16 numbers; with
//                                                                the frame's number before: 13 or 17
//                                                                (KITTI-360)
//   TUM        t tx ty tz qx qy qz qw                            seconds, T_wc
//   EuRoC      t,tx,ty,tz,qw,qx,qy,qz,...                        nanoseconds; TUM-VI's and ASL's csv, too
//   TartanAir  tx ty tz qx qy qz qw                              one line a frame
//
// Files with commas are EuRoC's. A header that names the columns is believed in every format with times, and
// columns that are no part of a pose are left out (slam/geometry/pose_table.h). Times:
// slam/geometry/time_unit.h. Lines need not be in the order of time, nor quaternions of length 1: they are
// sorted and divided by their length (as evo does), and a note says so.
//
// Readers throw InputError naming file and line: a wrong number of columns, something not a number, NaN, a
// matrix that is no rotation (an entry of R^T R off by more than kRotationTolerance, or det R < 0), a
// quaternion of length 0, no pose at all. KITTI rotations are kept exactly as read, rounding included (as evo
// does): re-orthonormalising would change the numbers that others compute from the same file. Writers keep 17
// digits, so that reading gives back the same doubles; they write under a temporary name first and throw
// Error where that fails.
//
// Sources: KITTI odometry development kit, readme; TUM RGB-D benchmark, "File Formats"; the ASL data set
// format of EuRoC; TartanAir, "Pose file format".
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

inline constexpr double kRotationTolerance = 1e-3;

enum class TrajectoryFormat { kitti, tum, euroc, tartanair };
const char* to_string(TrajectoryFormat format);
// Whether the format has times.
bool has_times(TrajectoryFormat format);

// What a reader did to a file that was not in order; a command or data set says it.
using Notes = std::vector<std::string>;

// Poses T_wc, one per line. The second form gives pose i the time i, for KITTI files carry none, or its frame
// number.
std::vector<SE3> read_kitti_poses(const std::filesystem::path& path);
Trajectory read_kitti_trajectory(const std::filesystem::path& path, Notes* notes = nullptr);
void write_kitti_poses(const std::filesystem::path& path, const std::vector<SE3>& poses);
void write_kitti_poses(const std::filesystem::path& path, const Trajectory& trajectory);

Trajectory read_tum_trajectory(const std::filesystem::path& path, Notes* notes = nullptr);
void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory);
Trajectory read_euroc_trajectory(const std::filesystem::path& path, Notes* notes = nullptr);
// Pose i gets the time i. TartanAir's axes are x forward, y right, z down; they are kept.
Trajectory read_tartanair_trajectory(const std::filesystem::path& path, Notes* notes = nullptr);

Trajectory read_trajectory(const std::filesystem::path& path, TrajectoryFormat format,
                           Notes* notes = nullptr);
// By the names of the columns, else the first record's number of columns and its commas. Throws InputError
// for any other.
TrajectoryFormat detect_trajectory_format(const std::filesystem::path& path);

}  // namespace penumbra::slam
