// Which pinhole camera, or pair of them, shows what real lenses see: turned how, and with which intrinsics.
//
// Turns (Bouguet): both cameras turn by half of their relative rotation, so that they look the same way, and
// then, by the smallest rotation, so that the baseline is their x axis.
//
//   R = R_right_left,  H = exp(-log(R) / 2),  t' = H t,  W: the rotation about t' x e that brings t' to e,
//   e = (+-1, 0, 0);   R_left = W H^T,  R_right = W H
//
// Radial-tangential lenses: the principal point puts the images of the corners around the image's middle;
// then the focal length is the smallest at which a grid of 9 x 9 points says that every pixel of the result
// comes from inside the real image (of a pair: from inside both, with one focal length and one principal
// point). Equidistant lenses: the same from the middles of the four sides.
//
// Between the steps points are rounded to floats and the grid's outermost points lie at width and height, as
// OpenCV 4.6 has it: with its cameras the results on recordings stay the same. Against cv::stereoRectify,
// cv::fisheye::stereoRectify, cv::getOptimalNewCameraMatrix and its fisheye counterpart, all with alpha 0,
// rotations and pixels differ by less than 1e-9 and 1e-6 (equidistant with fx = fy; else OpenCV 4.6 is in
// error). Source: Bouguet, Camera Calibration Toolbox for Matlab (stereo_rectify).
#pragma once

#include <Eigen/Core>

#include "slam/geometry/lens.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

struct Pinhole {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d K;
    K << fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0;
    return K;
  }
};

// From each real camera's frame to the rectified one. The translation is not zero.
struct RectifyingTurns {
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity(), right = Eigen::Matrix3d::Identity();
};
RectifyingTurns rectifying_turns(const SE3& T_right_left);

// Values that are not finite, or not above 0, where no view fits.
Pinhole rectified_view(const LensCamera& lens);
Pinhole rectified_view(const LensCamera& left, const LensCamera& right, const RectifyingTurns& turns);

}  // namespace penumbra::slam
