// ASFF before YOLOv5's heads: each of N3, N4, N5 becomes a mixture of all three (AFNET, docs/papers.md B.1).
//
//   y_l = asff(F_{3->l}, F_{4->l}, F_{5->l}),   l = 3, 4, 5
//   F_{k->l} = N_l                              k = l
//              Conv1x1(N_k), repeated           k > l: coarser
//              Conv3x3/2(N_k)                   k = l - 1
//              Conv3x3/2(maximum3x3/2(N_k))     k = l - 2
//
// Convs as in yolov5_blocks.h, to the channels of level l. There is no convolution behind the mixture as in
// the ASFF paper: at its 3 x 3 it would cost 40 % of YOLOv5n. Weights: asff.L.resize.K (Convs) and
// asff.L.weight.K (of lambda), L and K from 0. Cost: 17 % of YOLOv5n's multiply-adds.
// Source: Liu et al. 2019, Learning Spatial Fusion for Single-Shot Object Detection, section 3.2;
// weights_tools/reference/afnet.py is the oracle.
#pragma once

#include <array>

#include "nn/layers/asff.h"
#include "nn/models/yolov5_blocks.h"
#include "nn/models/yolov5_shape.h"

namespace penumbra::nn {

class Yolov5Fusion {
 public:
  Yolov5Fusion() = default;
  Yolov5Fusion(WeightReader& weights, const Yolov5Shape& shape);

  // `maps` are N3, N4 and N5; N3 and N4 with a border of 1 are not copied. The result's first map gets a
  // border of 1 where a mask head reads it.
  std::array<FeatureMap, 3> operator()(const std::array<FeatureMap, 3>& maps, Arena& arena) const;

 private:
  struct Level {
    std::array<Conv2d, 3> resize;  // from every other level
    Asff mix;
  };
  std::array<Level, 3> levels_;
  bool masks_ = false;
};

}  // namespace penumbra::nn
