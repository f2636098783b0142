// Mask R-CNN with a ResNet-50 FPN backbone, baseline or with mixed attention: image in, object instances out.
//
//   image -> transform -> ResNet (C2..C5) -> FPN (P2..P6) -> RPN -> box head -> mask head -> masks on the
//   image
//
// The weights decide the number of classes and whether the pyramid has attention. Defaults are those of
// torchvision's maskrcnn_resnet50_fpn, whose results it reproduces.
// Source: He et al. 2017; papers.md A.1; torchvision.models.detection.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "nn/io/image_transform.h"
#include "nn/layers/mask_paste.h"
#include "nn/models/box_head.h"
#include "nn/models/fpn.h"
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
};

// An object instance found in an image.
struct Detection {
  Box box;  // pixels of the image
  float score = 0.0F;
  int label = 0;  // class, as the weights number them; 0, background, does not occur
  Mask mask;
};

class MaskRcnn {
 public:
  // Throws InputError that lists every tensor that is missing, mis-shaped or not part of the network.
  // Metadata "batch_norm_eps" of the weights, where present, replaces the config's.
  explicit MaskRcnn(const StateDict& weights, MaskRcnnConfig config = {});

  int classes() const { return box_head_.classes(); }  // background included
  bool has_attention() const { return pyramid_.has_attention(); }

  // `image` is 8-bit grey or BGR of any size; detections come in order of falling score. Not thread-safe: the
  // network's memory is reused from image to image.
  std::vector<Detection> operator()(const cv::Mat& image);

  const Arena& arena() const { return arena_; }

 private:
  MaskRcnnConfig config_;
  ResNet backbone_;
  FeaturePyramid pyramid_;
  RegionProposalNetwork rpn_;
  BoxHead box_head_;
  MaskHead mask_head_;
  Arena arena_;
};

}  // namespace penumbra::nn
