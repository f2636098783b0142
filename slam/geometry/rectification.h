// Makes a rectified pair of pinhole images from what two real lenses see, or a pinhole image from one.
//
// Rectifying turns both cameras by half their relative rotation and so that their rows lie along the
// baseline; the common focal length is the smallest at which every pixel of the results comes from inside
// both images (slam/geometry/rectified_view.h). The tables of places are made once,
//
//   place(u, v) = pixel_of( R^-1 K^-1 (u, v, 1) )
//
// and applied with linear interpolation (nn/image/remap.h). Errors: of double arithmetic, rounded to floats.
#pragma once

#include <Eigen/Core>
#include <string>

#include "nn/image/remap.h"
#include "slam/geometry/lens.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

struct StereoRectification {
  StereoCamera camera;
  Remap left, right;
  Eigen::Matrix3d R_rectified_left = Eigen::Matrix3d::Identity();  // from the real left camera
};

// Throws InputError naming `place` where the cameras cannot be rectified: of different sizes, the right one
// not to the right (the baseline, in the left camera's frame, must point along +x more than along y or z), no
// usable image left.
StereoRectification rectify_stereo(const LensCamera& left, const LensCamera& right, const SE3& T_right_left,
                                   const std::string& place);

struct Undistortion {
  StereoCamera camera;  // without baseline
  Remap remap;
};

// Without distortion the camera comes back as it is. Throws InputError where no usable image is left.
Undistortion undistort(const LensCamera& camera, const std::string& place);

}  // namespace penumbra::slam
