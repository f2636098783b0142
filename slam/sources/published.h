// Data sets as they are downloaded that are two folders of images with the calibration somewhere else; one
// row of the table in published.cpp each. docs/datasets.md lists them.
//
//   KITTI raw         DATE/DATE_drive_NNNN_sync/image_00|02/data, image_01|03/data, timestamps.txt;
//                     DATE/calib_cam_to_cam.txt; truth from oxts/data with calib_imu_to_velo.txt and
//                     calib_velo_to_cam.txt
//   KITTI-360         data_2d_raw/DRIVE/image_00|01/data_rect, timestamps.txt;
//                     ../../calibration/perspective.txt; ../../data_poses/DRIVE/cam0_to_world.txt
//   Virtual KITTI 2   SCENE/VARIATION/frames/rgb/Camera_0|1; SCENE/VARIATION/extrinsic.txt
//   TartanAir         image_left, image_right, pose_left.txt
//   4Seasons          undistorted_images/cam0|1; ../calibration/undistorted_calib_0.txt, _stereo.txt
//   RobotCar          stereo/left|centre, stereo/right (slam/sources/robotcar.h)
//   ICL-NUIM          rgb, depth, associations.txt, *.gt.freiburg
#pragma once

#include <filesystem>
#include <memory>

#include "slam/sources/open_dataset.h"

namespace penumbra::slam {

// Whether the folder is laid out as one of them.
bool looks_like_published(const std::filesystem::path& path);

// Throws InputError naming the file and what is wrong with it.
std::unique_ptr<StereoDataset> open_published(const std::filesystem::path& path,
                                              const DatasetOptions& options);

}  // namespace penumbra::slam
