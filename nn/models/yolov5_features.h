// YOLOv5's backbone and neck: three maps that see fine detail and the whole image.
//
//   backbone   P1 = Conv6x6/2(image);  P_k = C3(Conv3x3/2(P_{k-1})), k = 2..5;  P5 then through SPPF
//   top-down   T5 = Conv1x1(P5);   T4 = Conv1x1(C3([up(T5) ; P4]));   N3 = C3([up(T4) ; P3])
//   bottom-up  N4 = C3([Conv3x3/2(N3) ; T4]);   N5 = C3([Conv3x3/2(N4) ; T5])
//
// up is nearest-neighbour upsampling by 2; strides of N3, N4, N5 are 8, 16, 32. The layers' numbers in the
// weights' names (model.0 to model.23) count upsampling and joining, too.
// Source: Liu et al. 2018, PANet; Jocher et al., YOLOv5 6.0; weights_tools/reference/yolov5.py is the oracle.
#pragma once

#include <array>

#include "nn/models/yolov5_blocks.h"
#include "nn/models/yolov5_shape.h"

namespace penumbra::nn {

class Yolov5Features {
 public:
  // Border that the image's feature map should have, so that the stem need not copy it.
  static constexpr int kImageBorder = 2;

  Yolov5Features() = default;
  Yolov5Features(WeightReader& weights, const Yolov5Shape& shape);

  // `image` is [1, 3, H, W] in blocks of 4, extents multiples of 32, and given back when the stem has read
  // it; gives N3 and N4 (with a border of 1) and N5.
  std::array<FeatureMap, 3> operator()(FeatureMap image, Arena& arena) const;

 private:
  struct Stage {
    Conv2d down;
    Yolov5C3 c3;
  };
  Conv2d stem_;
  std::array<Stage, 4> stages_;  // to P2, P3, P4, P5
  Yolov5Sppf sppf_;
  Conv2d lateral5_, lateral4_;  // T5, T4
  Yolov5C3 top_down4_, top_down3_;
  std::array<Stage, 2> bottom_up_;  // N4, N5
};

}  // namespace penumbra::nn
