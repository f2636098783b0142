// The building blocks of YOLOv5 (releases 6 and 7), named as in its state dicts.
//
//   Conv(x)   = silu(W * x + b)         k x k, stride s, padding k / 2; batch norm (eps 1e-3, or the
//                                       metadata's) folded
//   C3(x)     = cv3([ m(cv1(x)) ; cv2(x) ])       1 x 1 convolutions; half of the outputs each side
//     m       = n residual blocks  r(x) = x + cv2(cv1(x)),  1 x 1 then 3 x 3; without "x +" in the neck
//   with attention (AFNET, docs/papers.md B.1)  r(x) = x + H(cv2(cv1(x))): leaky_relu of slope 0.1 for silu,
//     H coordinate attention, whose squeezed map has max(8, C / 32) channels
//   SPPF(x)   = cv2([ z ; p(z) ; p(p(z)) ; p(p(p(z))) ]),  z = cv1(x),  p the maximum over 5 x 5, stride 1
//
// [ ; ] joins channels. Weights are `name`.conv.weight with either `name`.conv.bias, where the batch norm was
// folded before saving, or `name`.bn.*.
// Source: Wang et al. 2020, CSPNet (C3); He et al. 2014, spatial pyramid pooling (SPPF); Jocher et al.,
// YOLOv5 6.0. Written from the architecture; weights_tools/reference/yolov5.py is the oracle.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nn/layers/conv2d.h"
#include "nn/layers/coordinate_attention.h"
#include "nn/models/weight_reader.h"

namespace penumbra::nn {

struct Yolov5ConvShape {
  int inputs, outputs, kernel = 1, stride = 1;
  Activation activation = Activation::silu;
};

enum class Yolov5Residual { none, shortcut, shortcut_and_attention };

// A Conv; `input_block` as in Conv2d.
Conv2d yolov5_conv(WeightReader& weights, const std::string& name, const Yolov5ConvShape& shape,
                   int input_block = kBlock);

class Yolov5C3 {
 public:
  Yolov5C3() = default;
  Yolov5C3(WeightReader& weights, const std::string& name, int inputs, int outputs, int repetitions,
           Yolov5Residual kind);

  FeatureMap operator()(const FeatureMap& x, Arena& arena, int output_border = 0) const;

 private:
  struct Residual {
    Conv2d cv1, cv2;
    std::optional<CoordinateAttention> attention;
  };
  Conv2d cv1_, cv2_, cv3_;
  std::vector<Residual> residuals_;
  bool shortcut_ = true;
};

class Yolov5Sppf {
 public:
  Yolov5Sppf() = default;
  Yolov5Sppf(WeightReader& weights, const std::string& name, int channels);

  FeatureMap operator()(const FeatureMap& x, Arena& arena) const;

 private:
  Conv2d cv1_, cv2_;
};

}  // namespace penumbra::nn
