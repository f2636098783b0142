// The calibration file of a KITTI odometry sequence.
#pragma once

#include <filesystem>

#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// The pair of cameras `left` and `right` (0 and 1 grey, 2 and 3 colour) of a calib.txt; width and height are
// left at 0. Throws InputError naming file and line: a label that is not KITTI's (Tr and those of the
// raw data are known and not used) or stands twice, a matrix that is missing, incomplete or not numeric,
// focal lengths <= 0, cameras that differ in K (the pair is not rectified), baseline <= 0 (left and right
// swapped).
StereoCamera read_kitti_calibration(const std::filesystem::path& path, int left, int right);

}  // namespace penumbra::slam
