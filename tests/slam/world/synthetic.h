// Small synthetic inputs for the SLAM's tests.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::test {

// Grey image with structure at several scales; a function of the seed.
cv::Mat textured_image(int width, int height, int seed);

// A camera like KITTI's.
slam::StereoCamera test_camera();

// Points in front of a camera at the origin that it sees, 4 to 40 metres away.
std::vector<Eigen::Vector3d> visible_points(const slam::StereoCamera& camera, int count, int seed);

// A motion of about `translation` metres and `angle` radians.
slam::SE3 random_motion(int seed, double translation, double angle);

}  // namespace penumbra::test
