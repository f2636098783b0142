// YOLOv5's heads: boxes with class scores for every cell of three maps, and prototype masks.
//
//   t = Conv1x1(N_k): for each of 3 anchors (a_w, a_h) of a cell (i, j) of stride s
//     centre x = (2 sigmoid(t_0) - 1/2 + j) s      width  = (2 sigmoid(t_2))^2 a_w
//     centre y = (2 sigmoid(t_1) - 1/2 + i) s      height = (2 sigmoid(t_3))^2 a_h
//     score of class c = sigmoid(t_4) sigmoid(t_{5+c});   with masks, t_{5+C} .. t_{5+C+31} are coefficients
//   prototypes = Conv1x1(Conv3x3(up(Conv3x3(N_3)))): 32 maps at stride 4
//
// Anchors are the weights' own (model.24.anchors, in cells), else those clustered on COCO.
// Source: Redmon and Farhadi 2018, YOLOv3 (anchors); Jocher et al., YOLOv5 6.0 (decoding); Bolya et al. 2019,
// YOLACT (prototypes); weights_tools/reference/yolov5.py is the oracle.
#pragma once

#include <array>
#include <cstddef>

#include "nn/layers/box.h"
#include "nn/models/yolov5_blocks.h"
#include "nn/models/yolov5_shape.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

struct Yolov5Output {
  std::array<FeatureMap, 3> levels;  // t: [1, 3 (5 + C (+ 32)), H / s, W / s], s = 8, 16, 32
  FeatureMap prototypes;             // [1, 32, H / 4, W / 4]; empty without masks
};

// A box that one anchor proposes for one class.
struct Yolov5Candidate {
  Box box;  // pixels of the network's input
  float score = 0.0F;
  int label = 0;  // class, 0..C - 1
  int level = 0, anchor = 0, row = 0, column = 0;
};

class Yolov5Head {
 public:
  Yolov5Head() = default;
  Yolov5Head(WeightReader& weights, const Yolov5Shape& shape);

  int classes() const { return classes_; }
  bool has_masks() const { return masks_; }

  Yolov5Output operator()(const std::array<FeatureMap, 3>& maps, Arena& arena) const;

  // The candidates of objectness and score above `threshold`, or where there are more than `capacity` the
  // best of them; level by level, anchor by anchor, row by row. A box comes once for each class that passes.
  ArenaVector<Yolov5Candidate> decode(const Yolov5Output& output, float threshold, std::size_t capacity,
                                      Arena& arena) const;

  // The candidate's 32 mask coefficients.
  std::array<float, kPrototypes> coefficients(const Yolov5Output& output,
                                              const Yolov5Candidate& candidate) const;

 private:
  struct Anchor {
    float width, height;  // pixels
  };
  int values() const { return kBoxValues + classes_ + (masks_ ? kPrototypes : 0); }  // an anchor

  int classes_ = 0;
  bool masks_ = false;
  std::array<std::array<Anchor, kAnchorsPerCell>, 3> anchors_{};
  std::array<Conv2d, 3> predictors_;
  Conv2d prototype1_, prototype2_, prototype3_;
};

}  // namespace penumbra::nn
