// The poses in RobotCar's files: what its inertial unit and its odometry wrote.
//
//   rtk.csv, gps/ins.csv   a pose a line: timestamp, northing, easting, down, roll, pitch, yaw
//   vo/vo.csv              a step a line: source_timestamp destination_timestamp x y z roll pitch yaw
//                          of T_destination_source
//
// Times are whole microseconds; the first line names the columns, of which others are left out.
//   R = Rz(yaw) Ry(pitch) Rx(roll)
#pragma once

#include <filesystem>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

inline constexpr double kRobotCarTime = 1e-6;  // seconds, of 1 in its files

// The motion of x y z roll pitch yaw, in metres and radians.
SE3 robotcar_motion(const double* numbers);

// T_w_ins. This and the next throw InputError with file and line for a column that is missing or no number.
Trajectory read_robotcar_inertial(const std::filesystem::path& path);

// T_w_vehicle: the steps one after another, from the identity at the first.
Trajectory read_robotcar_odometry(const std::filesystem::path& path);

// At these times, between poses that are at most a fifth of a second apart; a time that has none is left out.
Trajectory interpolated(const Trajectory& poses, const std::vector<double>& times);

}  // namespace penumbra::slam
