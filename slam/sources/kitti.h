// KITTI odometry layout (Geiger et al., CVPR 2012; development kit of the odometry benchmark).
//
//   ROOT/sequences/NN/calib.txt           "P0: " and 12 numbers: 3 x 4 projection, row by row; P1..P3
//                                         likewise
//   ROOT/sequences/NN/times.txt           seconds, one line a frame
//   ROOT/sequences/NN/image_0, image_1    left and right grey images 000000.png, 000001.png, ... (.jpg too)
//   ROOT/sequences/NN/image_2, image_3    left and right colour images
//   ROOT/sequences/NN/name.txt            one line: what to call the recording; KITTI's have none
//   ROOT/poses/NN.txt                     ground truth T_wc, one line a frame; absent for sequences 11..21
//
// PATH is ROOT (then `sequence` names NN; not needed where there is only one) or a sequence's own folder,
// whose ground truth is looked for in poses.txt inside and in ../../poses/NN.txt.
//
// Camera: K from the left projection matrix, baseline b = (P_left[0][3] - P_right[0][3]) / fx, with P0 and P1
// for grey, P2 and P3 for colour.
//
// Ground truth holds the poses of the frames read, as they stand in the file: the world is camera 0 at the
// sequence's frame 0, also where the range begins later (evaluation aligns or compares relative motion).
// KITTI gives the path of camera 0 only; for colour images the same path is used, as the benchmark does,
// although camera 2 sits 6 cm beside camera 0.
//
// Frames: images are numbered without gaps, from 000000 or, in a piece of a sequence, from any other number;
// image i belongs to line i of times and poses, which may have more lines than there are images; or, where
// there are as many lines as images, the first to the first. Of frames with one time the first is taken;
// times in other units than seconds are taken with a note (slam/geometry/time_unit.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "slam/sources/open_dataset.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

// Throws InputError naming the file and what is wrong with it: missing folders, left and right images that do
// not pair, calibration without the two matrices or with numbers that no camera has, missing times (unless
// options.frame_rate is given), too few times or poses, NaN, times that do not increase, unreadable images.
// All but the images is checked here; of the images the first pair is (it gives the size), each other when it
// is loaded. StereoImages::index counts from the sequence's frame 0. Cost: lists two folders, reads one pair.
std::unique_ptr<StereoDataset> open_kitti(const std::filesystem::path& path, const DatasetOptions& options);

// Names of the sequences of a root, sorted; empty where `path` is no root.
std::vector<std::string> kitti_sequences(const std::filesystem::path& path);

// Whether `path` is a root (sequences/) or the folder of a sequence (calib.txt, image_0/ or image_2/).
bool looks_like_kitti(const std::filesystem::path& path);

}  // namespace penumbra::slam
