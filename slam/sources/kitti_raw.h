// The text files of KITTI's raw data and KITTI-360.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

// The pair of rectified cameras `left` and `right` of calib_cam_to_cam.txt or perspective.txt: P_rect_NN and
// S_rect_NN. Throws InputError for labels that are missing and numbers that no pair has.
StereoCamera read_kitti_raw_calibration(const std::filesystem::path& path, int left, int right);

// Seconds since 1970 of timestamps.txt, "2011-09-26 13:02:25.064389445" a line. Throws InputError
// (file:line).
std::vector<double> read_date_list(const std::filesystem::path& path);

// T_wc of the rectified camera `left` from the packets of oxts/data, the world being the first pose; the time
// of each is the frame's number. Latitude and longitude, in degrees, become metres by Mercator's projection
// at the first latitude:
//
//   x = s r lon pi / 180,   y = s r log tan((90 + lat) pi / 360),   s = cos(lat_0 pi / 180), r = 6378137 m
//
// Empty, with a note, where calib_imu_to_velo.txt or calib_velo_to_cam.txt is missing. Source: KITTI's devkit
// for raw data.
Trajectory read_oxts_poses(const std::filesystem::path& drive, int left, std::vector<std::string>& notes);

}  // namespace penumbra::slam
