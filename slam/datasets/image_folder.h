// Folders of images from any camera, with a calibration.yaml: see docs/datasets.md.
//
//   calibration.yaml        the camera (slam/datasets/camera_file.h)
//   left/, right/           stereo pairs: images of the same name, whatever their ending
//   rgb/, depth/            or, RGB-D: images of the same name; depth are 16-bit PNGs
//   times.txt               optional: seconds, one line a frame
//   groundtruth.txt         optional: TUM trajectory of the left camera; or poses.txt, KITTI's, a line a
//   frame
//
// Frames are in the order of their names. Times come from times.txt; or from names that are whole numbers of
// at least 15 digits (nanoseconds) or numbers with a point (seconds); or from the frame rate, `rate` in the
// calibration or `options.frame_rate`.
#pragma once

#include <filesystem>
#include <memory>

#include "slam/datasets/open_dataset.h"
#include "slam/datasets/stereo_dataset.h"

namespace penumbra::slam {

// Throws InputError naming the file and what is wrong with it.
std::unique_ptr<StereoDataset> open_image_folder(const std::filesystem::path& path,
                                                 const DatasetOptions& options);

// Whether there is a calibration.yaml.
bool looks_like_image_folder(const std::filesystem::path& path);

}  // namespace penumbra::slam
