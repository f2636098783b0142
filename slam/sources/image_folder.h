// Folders of images from any camera, with a calibration.yaml: see docs/datasets.md.
//
//   calibration.yaml        the camera (slam/sources/calibration/calibration.h)
//   left/, right/           stereo pairs: images of the same name (slam/sources/image_pairs.h)
//   side_by_side/           or images whose halves are left and right, as a ZED takes them
//   rgb/, depth/            or, RGB-D: images of the same name; depth are 16-bit PNGs
//   times.txt               optional: one line a left image, in the order of their names
//   groundtruth.txt         optional: TUM trajectory of the left camera; or poses.txt, KITTI's, a line for
//                           each left image
//
// Frames are in the order of their names, 2 before 10. Times come from times.txt; or from names that are
// whole numbers (a clock's, of at least 10 digits) or numbers with a point; or from the frame rate, `rate` in
// the calibration or `options.frame_rate`. The unit of times: slam/geometry/time_unit.h. A time belongs to
// the image's place before images without a partner are left out, so that a lost image shifts no others.
#pragma once

#include <filesystem>
#include <memory>

#include "slam/sources/open_dataset.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Throws InputError naming the file and what is wrong with it.
std::unique_ptr<StereoDataset> open_image_folder(const std::filesystem::path& path,
                                                 const DatasetOptions& options);

// Whether there is a calibration.yaml.
bool looks_like_image_folder(const std::filesystem::path& path);

}  // namespace penumbra::slam
