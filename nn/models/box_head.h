// Box head: names each proposal and refines its box.
//
//   f = relu(W_7 relu(W_6 flatten(RoIAlign_7x7(P, proposal)))), or without W_7;  class logits = W_c f, box
//   deltas (4 a class) = W_b f scores = softmax(logits); boxes decoded with weights (10, 10, 5, 5) and
//   clipped to the image; keep scores > 0.05 of classes >= 1 (0 is background) with sides of 0.01 or more,
//   NMS per class at 0.5, best 100
//
// Source: Girshick 2015, Fast R-CNN; torchvision.models.detection.roi_heads.RoIHeads.postprocess_detections.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "nn/layers/box.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/nms.h"
#include "nn/layers/roi_align.h"
#include "nn/models/rpn.h"

namespace penumbra::nn {

struct BoxHeadConfig {
  int layers = 2;  // hidden fully connected layers: W_6, or W_6 and W_7; the weights decide their width
  RoiAlignOptions roi_align{7, 2};
  float score_threshold = 0.05F;
  float nms_threshold = 0.5F;
  int max_detections = 100;
  float min_side = 1e-2F;  // pixels
};

struct ScoredBox {
  Box box;  // pixels of the network's input
  float score = 0.0F;
  int label = 0;  // class, 1..classes - 1
};

class BoxHead {
 public:
  BoxHead() = default;
  // The weights decide the number of classes, background included.
  // `channels` are those of the pyramid.
  BoxHead(WeightReader& weights, const std::string& prefix, int channels, const BoxHeadConfig& config);

  int classes() const { return classes_; }

  // Detections in order of falling score; room for max_detections of them.
  ArenaVector<ScoredBox> operator()(std::span<const PyramidLevel> pyramid, const ArenaVector<Box>& proposals,
                                    const ImageExtent& image, Arena& arena) const;

 private:
  // Adds what the proposals, at most `capacity` of them, hold of all classes.
  void classify(std::span<const PyramidLevel> pyramid, std::span<const Box> proposals, int capacity,
                const ImageExtent& image, Candidates& candidates, Arena& arena) const;

  BoxHeadConfig config_;
  int classes_ = 0;
  std::vector<Conv2d> hidden_;  // fc6, fc7
  Conv2d class_logits_, box_deltas_;
};

}  // namespace penumbra::nn
