// The calibration file of a KITTI odometry sequence.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// A 3 x 4 projection matrix of a rectified camera, row by row, and where it stands.
struct ProjectionRow {
  std::string place;
  std::vector<double> values;
};
// The pair of rectified cameras that two matrices describe; width and height are left at 0. `left_number`:
// for messages. Throws InputError for focal lengths <= 0, cameras that differ in K (the pair is not
// rectified), baseline <= 0 (left and right swapped).
StereoCamera pair_of(const ProjectionRow& left, const ProjectionRow& right, int left_number);

// The pair of cameras `left` and `right` (0 and 1 grey, 2 and 3 colour) of a calib.txt; width and height are
// left at 0. Throws InputError naming file and line: a label that is not KITTI's (Tr and those of the
// raw data are known and not used) or stands twice, a matrix that is missing, incomplete or not numeric, and
// as pair_of() does.
StereoCamera read_kitti_calibration(const std::filesystem::path& path, int left, int right);

}  // namespace penumbra::slam
