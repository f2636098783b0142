// TUM RGB-D layout (Sturm et al., IROS 2012), also what `penumbra synth --sensor rgbd` writes.
//
//   rgb.txt, depth.txt      "SECONDS NAME" a line
//   rgb/, depth/            colour images; depth, 16-bit PNGs with 5000 levels a metre, 0 = unknown
//   groundtruth.txt         optional: TUM trajectory of the camera
//   calibration.yaml        optional, see docs/datasets.md; or ETH3D's calibration.txt; otherwise the camera
//                           is known by the folder's name, which says freiburg1, freiburg2 or freiburg3 (or
//                           fr1, fr2, fr3), or rgbd_bonn
//
// OpenLORIS-Scene lies the same way with other names: color.txt, aligned_depth.txt, and sensors.yaml
// (openloris.h).
//
// A frame is a colour image and the depth image nearest in time, at most 0.02 s away; images without a
// partner are left out, with a note. The frame's time is the colour image's. Colour and depth of freiburg1
// and 2 are undistorted alike: depth is registered to the colour camera.
#pragma once

#include <filesystem>
#include <memory>

#include "slam/sources/open_dataset.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Throws InputError naming the file and what is wrong with it.
std::unique_ptr<StereoDataset> open_tum(const std::filesystem::path& path, const DatasetOptions& options);

// Whether there is an rgb.txt, an rgb/ without calibration.yaml, or OpenLORIS' two lists.
bool looks_like_tum(const std::filesystem::path& path);

}  // namespace penumbra::slam
