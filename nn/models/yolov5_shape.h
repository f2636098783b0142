// How large a YOLOv5 is: one description, scaled in width and depth.
//
//   channels of stage k = 8 ceil(width 64 2^k / 8),  k = 0..4
//   repetitions of a C3 = max(round(depth n), 1)
//
//   model   n     s     m     l    x        n = 3 6 9 3 in the backbone, 3 in the neck
//   depth  1/3   1/3   2/3    1   4/3
//   width  1/4   1/2   3/4    1   5/4
//
// Source: Jocher et al., YOLOv5 6.0.
#pragma once

#include <array>
#include <string>

#include "nn/models/weight_reader.h"

namespace penumbra::nn {

struct Yolov5Shape {
  std::array<int, 5> channels{16, 32, 64, 128, 256};  // of the stages at strides 2, 4, 8, 16, 32
  std::array<int, 4> backbone_repetitions{1, 2, 3, 1};
  int neck_repetitions = 1;
  int prototype_channels = 64;  // inside the mask branch: 8 ceil(256 width / 8)
  int classes = 80;
  bool masks = false;  // with the segmentation head
  // The two parts of AFNET: coordinate attention in the backbone's residual units, ASFF before the head.
  bool attention = false, fusion = false;
  double width = 0.25, depth = 1.0 / 3.0;

  // "YOLOv5n", "YOLOv5s-seg", ...; multiples in brackets where they are no model's. "AFNET-n" with both of
  // its parts, "YOLOv5n with ASFF" with one.
  std::string name() const;
};

constexpr int kPrototypes = 32;  // masks a segmentation head combines
constexpr int kAnchorsPerCell = 3;
constexpr int kBoxValues = 5;  // centre, size and objectness

Yolov5Shape yolov5_shape(double width, double depth, int classes, bool masks);

// What the weights come closest to: width by the stem, depth by the blocks of the backbone's third C3,
// classes by the head, AFNET's parts by the first tensor of each. What they lack of it, or have beyond it, is
// noted when the network reads them.
Yolov5Shape yolov5_shape(const WeightReader& weights);

}  // namespace penumbra::nn
