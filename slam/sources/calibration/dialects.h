// How other tools write a camera's calibration. Each is told by keys that no other has; docs/datasets.md has
// the table. T_b_a takes points from the frame of a to that of b.
//
//   Kalibr's camchain   cam0 and cam1: intrinsics [fx, fy, cx, cy], distortion_model and _coeffs, resolution;
//   (and OpenVINS's)    cam1's T_cn_cnm1 = T_right_left, else T_cam_imu, or OpenVINS's T_imu_cam, of both
//   ORB-SLAM2 and 3     Camera.fx ... with Camera.bf = baseline fx, or LEFT.K, D, R, P and RIGHT's, raw;
//                       Camera1.fx ... with Stereo.b, or Camera2.fx ... with Stereo.T_c1_c2 = T_left_right
//   ROS's camera_info   camera_matrix, distortion_coefficients, rectification_matrix R and projection_matrix
//                       P of each camera: T_right_left = R_right^T (R_left, (P_right[3] / P_right[0], 0, 0))
//   OpenCV's storage    K1, D1, K2, D2, R, T of stereoCalibrate: T_right_left = (R, T)
//   sensor.yaml         of EuRoC and TUM-VI, one a camera: T_right_left = T_BS(right)^-1 T_BS(left)
//   Basalt              JSON: T_imu_cam and intrinsics of each camera
//   ETH3D               fx fy cx cy in one line
//
// Keys that say nothing about the lenses are not looked at. Reading throws InputError (file:line) for what is
// missing, models that Penumbra lacks, and numbers that no camera has.
#pragma once

#include <filesystem>
#include <string_view>

#include "slam/sources/calibration/camera_file.h"
#include "slam/sources/calibration/yaml_file.h"

namespace penumbra::slam {

struct CalibrationDialect {
  std::string_view name;                     // "Kalibr's camchain"
  bool (*is_spoken)(const YamlFile& yaml);   // by its keys
  CameraFile (*read)(const YamlFile& yaml);  // of one camera, or of both
};

extern const CalibrationDialect kKalibr, kOrbSlam, kCameraInfo, kOpencvStorage, kSensorYaml;

// Two files, one a camera, of ROS or sensor.yaml.
CameraFile read_camera_info_pair(const YamlFile& left, const YamlFile& right);
CameraFile read_sensor_yaml_pair(const std::filesystem::path& left, const std::filesystem::path& right);

CameraFile read_basalt(const std::filesystem::path& path);
CameraFile read_eth3d(const std::filesystem::path& path);

}  // namespace penumbra::slam
