// The text files of KITTI's raw data and KITTI-360.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/mounting.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// The pair of rectified cameras `left` and `right` of calib_cam_to_cam.txt or perspective.txt: P_rect_NN and
// S_rect_NN. Throws InputError for labels that are missing and numbers that no pair has.
StereoCamera read_kitti_raw_calibration(const std::filesystem::path& path, int left, int right);

// Seconds since 1970 of timestamps.txt, "2011-09-26 13:02:25.064389445" a line. Throws InputError
// (file:line).
std::vector<double> read_date_list(const std::filesystem::path& path);

// Where the rectified camera `left` stands in the frame of the inertial sensor, "imu", by the files beside
// calib_cam_to_cam.txt in the folder of the day; nothing where one is missing.
//
//   T_imu_left = (T_left_cam0 T_cam0_velo T_velo_imu)^-1
//   T_left_cam0 = (R_rect_00, b),   b_x = P_rect_NN[3] / P_rect_NN[0]
std::optional<Mounting> read_kitti_raw_mounting(const std::filesystem::path& day, int left);

// The same of KITTI-360's left camera, T_imu_camera R_rect_00^-1 of calib_cam_to_pose.txt and perspective.txt
// in this folder. Source: Liao et al., KITTI-360 (PAMI 2022), and its scripts.
std::optional<Mounting> read_kitti_360_mounting(const std::filesystem::path& calibration);

// T_wc of the camera so mounted from the packets of oxts/data, the world being the first pose; the time of
// each is the frame's number. Latitude and longitude, in degrees, become metres by Mercator's projection at
// the first latitude:
//
//   x = s r lon pi / 180,   y = s r log tan((90 + lat) pi / 360),   s = cos(lat_0 pi / 180), r = 6378137 m
//
// Source: KITTI's devkit for raw data.
Trajectory read_oxts_poses(const std::filesystem::path& drive, const SE3& T_imu_camera);

}  // namespace penumbra::slam
