// Mask R-CNN with a ResNet FPN backbone, baseline or with mixed attention: image in, object instances out.
//
//   image -> transform -> ResNet (C2..C5) -> FPN (P2..P6) -> RPN -> box head -> mask head -> masks on the
//   image
//
// The weights decide the number of classes, the ResNet's depth and width, and whether the pyramid has
// attention. Defaults are those of torchvision's maskrcnn_resnet50_fpn, whose results it reproduces.
// Source: He et al. 2017; papers.md A.1; torchvision.models.detection.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "nn/io/image_transform.h"
#include "nn/models/box_head.h"
#include "nn/models/fpn.h"
#include "nn/models/instance_segmenter.h"
#include "nn/models/mask_head.h"
#include "nn/models/resnet.h"
#include "nn/models/rpn.h"

namespace penumbra::nn {

struct MaskRcnnConfig {
  ImageTransform transform;
  RpnConfig rpn;
  BoxHeadConfig box_head;
  MaskHeadConfig mask_head;
  float batch_norm_eps = 1e-5F;  // 0 for torchvision's released COCO_V1 weights
  float mask_threshold = 0.5F;
  bool attention = true;  // false: leave out attention weights, the baseline network
};

class MaskRcnn : public InstanceSegmenter {
 public:
  // Throws InputError that lists every tensor that is missing, mis-shaped or not part of the network.
  // Metadata "batch_norm_eps" of the weights, where present, replaces the config's.
  explicit MaskRcnn(const StateDict& weights, MaskRcnnConfig config = {});

  std::string name() const override;
  int classes() const override { return box_head_.classes(); }
  bool has_masks() const override { return true; }
  bool has_attention() const { return pyramid_.has_attention(); }

  using InstanceSegmenter::detect;
  void detect(const cv::Mat& image, Arena& arena, std::vector<Detection>& detections) const override;

 private:
  MaskRcnnConfig config_;
  ResNet backbone_;
  FeaturePyramid pyramid_;
  RegionProposalNetwork rpn_;
  BoxHead box_head_;
  MaskHead mask_head_;
};

}  // namespace penumbra::nn
