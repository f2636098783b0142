// EuRoC MAV layout (Burri et al., IJRR 2016): raw stereo pairs, which are undistorted and rectified here.
//
//   mav0/cam0, mav0/cam1       left and right camera, each:
//     sensor.yaml              resolution, intrinsics, distortion_model, distortion_coefficients, T_BS; where
//                              it is missing dso/camchain.yaml beside mav0/, as TUM-VI has it
//     data.csv                 "NANOSECONDS,NAME" a line
//     data/                    the images (PNG or JPEG)
//   mav0/state_groundtruth_estimate0/data.csv
//                              "NANOSECONDS, p_RS_R (x y z), q_RS (w x y z), ..." a line: T_WB of the body;
//   or mav0/mocap0/data.csv    TUM-VI's, likewise;
//   or groundtruth_tum.txt     beside mav0/: the same in TUM format
//
// PATH is the folder with mav0/, or mav0/ itself. Pairs are images with the same time (to 1 ms); images
// without a partner are left out, with a note. Ground truth is that of the body; the pose of the left
// rectified camera is T_WC = T_WB T_BS(cam0) R^T with R the rotation that rectifies it.
#pragma once

#include <filesystem>
#include <memory>

#include "slam/sources/open_dataset.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Throws InputError naming the file and what is wrong with it: missing files, calibration with numbers that
// no camera has, cameras that cannot be rectified, times that go back, no pairs.
std::unique_ptr<StereoDataset> open_euroc(const std::filesystem::path& path, const DatasetOptions& options);

// Whether there is a mav0/, or a cam0/ with a sensor.yaml.
bool looks_like_euroc(const std::filesystem::path& path);

}  // namespace penumbra::slam
