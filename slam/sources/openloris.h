// What OpenLORIS-Scene says of its robot's RealSense D435i, beside lists of images like TUM's (tum.h): the
// colour camera, to which aligned_depth/ is registered, and where it stands on the robot.
//
//   sensors.yaml        OpenCV's storage: d400_color_optical_frame with width, height, fps,
//                       intrinsics 1 x 4: fx cx fy cy (in this order), distortion_model,
//                       distortion_coefficients
//   trans_matrix.yaml   entries of parent_frame, child_frame and a matrix 4 x 4: T_parent_child
//   groundtruth.txt     path of the robot's base_link
//
// Source: Shi et al., Are we ready for service robots? The OpenLORIS-Scene datasets for lifelong SLAM (ICRA
// 2020), and its tools.
#pragma once

#include <filesystem>
#include <optional>

#include "slam/geometry/se3.h"
#include "slam/sources/calibration/camera_file.h"

namespace penumbra::slam {

// Throw InputError (file:line) for files of another form.
CameraFile read_openloris_camera(const std::filesystem::path& sensors_yaml);
// T_base_camera of the colour camera; nothing where the file has no such entry.
std::optional<SE3> read_openloris_mounting(const std::filesystem::path& trans_matrix_yaml);

}  // namespace penumbra::slam
