// Writers of a sequence in the layouts of two benchmarks.
#pragma once

#include <filesystem>
#include <functional>

#include "slam/world/sequence.h"

namespace penumbra::slam::synthetic {

// Writes a stereo sequence below `folder`:
//   sequences/00/image_0, image_1 [, image_2, image_3]/NNNNNN.png    left, right; grey, then colour
//   sequences/00/calib.txt, times.txt, name.txt (what to call it in logs and reports)
//   sequences/00/plan.pgm, plan.yaml    where a robot could drive, see plan_truth.h
//   sequences/00/instances/NNNNNN.png   16 bits: instance ids of the left image, 0 = background
//   sequences/00/instances.json         per id: class and whether it moves
//   sequences/00/depth/NNNNNN.png       16 bits, 256 = 1 m, 0 = sky or beyond 255 m (where recording.depth)
//   sequences/00/disparity/NNNNNN.png   16 bits, 256 = 1 pixel, 0 = sky (where recording.disparity)
//   sequences/00/flow/NNNNNN.png        3 x 16 bits as KITTI's flow, to the next frame (where recording.flow)
//   sequences/00/amodal/NNNNNN/IIIII.png  8 bits: 255 on the whole of instance IIIII (where recording.amodal)
//   sequences/00/landmarks/NNNNNN.png   16 bits: which thing each pixel of the left image shows, houses,
//                                       trees and lamps too, 0 = ground, sky (where recording.landmarks)
//   sequences/00/landmarks.json         per number: class and whether it moves
//   annotations/instances.json          COCO, see coco_annotations.h (where recording.annotations)
//   poses/00.txt                        T_wc of the left camera, the first the identity
// `folder` must be missing or empty unless `overwrite`; then what an earlier run wrote there is removed
// first. `progress` is called after every frame with the number of frames done. Throws UsageError for a
// folder that is not empty, Error where writing fails.
void write_kitti_layout(Sequence& sequence, const std::filesystem::path& folder, bool overwrite,
                        const std::function<void(int)>& progress = {});

// Writes an RGB-D sequence as TUM lays its own out:
//   rgb/T.png, depth/T.png       colour; 16 bits, 5000 = 1 m, 0 = no depth (see depth_sensor.h); T in seconds
//   rgb.txt, depth.txt           "T folder/T.png" a line
//   groundtruth.txt              T tx ty tz qx qy qz qw: T_wc of the optical frame, the first the identity
//   calibration.yaml             width, height, fx, fy, cx, cy, depth_factor, rate
//   instances/T.png, instances.json, plan.pgm, plan.yaml  as above
//   depth_clean/T.png, depth_clean.txt  the true depth, coded like depth (where recording.depth)
//   flow/T.png, amodal/T/IIIII.png, landmarks/T.png, landmarks.json, annotations/instances.json   as above,
//   where the recording has them
// `folder` and errors as above.
void write_tum_layout(Sequence& sequence, const std::filesystem::path& folder, bool overwrite,
                      const std::function<void(int)>& progress = {});

}  // namespace penumbra::slam::synthetic
