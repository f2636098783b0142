// The camera of a recording, from what its drivers said of it (sensor_msgs/CameraInfo).
//
//   raw images         K and D of each lens; rectified (slam/geometry/rectification.h) by R and P of both:
//                      T_right_left = { R_right^T R_left, R_right^T (-b, 0, 0) },
//                      b = (P_left[3] - P_right[3]) / fx
//   rectified images   P: fx = P[0], cx = P[2], fy = P[5], cy = P[6]; P[3] = -fx b of the right camera
//   binning and roi    K and P are those of the whole image: c -= roi offset, then f, c and size by
//                      the binning
//
// Images are rectified where their topic's name has the word "rect", or where there is nothing to rectify: D
// is all zeros, R no rotation, and P begins with K. Distortion: plumb_bob, rational_polynomial, equidistant
// (fisheye). Sources: sensor_msgs/CameraInfo.msg; image_geometry; REP 104.
#pragma once

#include <string>
#include <string_view>

#include "slam/sources/bag/messages.h"
#include "slam/sources/calibration/camera_file.h"

namespace penumbra::slam {

// What one camera said, and of which topic, which names it in errors.
struct SaidCamera {
  const CameraInfoMessage& info;
  std::string topic;
};

// Whether a topic's name says that its images are rectified: /left/image_rect_color.
bool says_rectified(std::string_view image_topic);

// Throw InputError naming the topic where the camera is not calibrated (K is zeros), where P has no baseline,
// and for distortion that is of none of these models.
RecordedCamera stereo_camera(const SaidCamera& left, const SaidCamera& right, bool names_say_rectified);
// Whether P says how far the cameras are apart.
bool has_baseline(const CameraInfoMessage& left, const CameraInfoMessage& right);
// The same where it does not, by where the cameras stand: raw images by K and D of each, rectified ones by P,
// and turned by R.
RecordedCamera stereo_camera_at(const SaidCamera& left, const SaidCamera& right, const SE3& T_right_left,
                                bool names_say_rectified);
// The camera of the colour image, to which depth is registered; the baseline is kNominalBaseline.
RecordedCamera rgbd_camera(const SaidCamera& said, bool name_says_rectified);

// Whether two cameras have one K and one size: depth that is registered to colour is seen by colour's camera.
bool is_same_camera(const CameraInfoMessage& a, const CameraInfoMessage& b);

}  // namespace penumbra::slam
