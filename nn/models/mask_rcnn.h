// Mask R-CNN with a ResNet FPN backbone, baseline or with mixed attention: image in, object instances out.
//
//   image -> transform -> ResNet (C2..C5) -> FPN (P2..P6) -> RPN -> box head -> mask head
//         -> masks on the image
//
// The weights decide the number of classes, the ResNet's depth and width, the pyramid's channels and whether
// it has attention. Defaults are those of torchvision's maskrcnn_resnet50_fpn, whose results it reproduces.
// What tensors cannot tell of other networks stands in the weights' metadata and replaces the config's:
//
//   batch_norm_eps                       0..1
//   box_head_layers, mask_head_layers    1..2, 1..8
//   anchor_sizes                         five, for P2..P6, in pixels: "32,64,128,256,512"
//   min_size, max_size                   image sides at the network, pixels; see nn/io/image_transform.h
//   rpn_candidates, rpn_proposals        the best of a level, of an image
//
// Source: He et al. 2017; docs/papers.md A.1; torchvision.models.detection.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nn/io/image_transform.h"
#include "nn/models/box_head.h"
#include "nn/models/fpn.h"
#include "nn/models/instance_segmenter.h"
#include "nn/models/layer_precision.h"
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
  LayerPrecision precision;
  bool attention = true;  // false: leave out attention weights, the baseline network
  // What the user asks for, instead of the weights' own: sizes in pixels, and regions that reach the heads.
  std::optional<int> min_size, max_size, proposals;
};

class MaskRcnn : public InstanceSegmenter {
 public:
  // Throws InputError that lists every tensor that is missing, mis-shaped or not part of the network.
  // The same for metadata that are no such numbers.
  explicit MaskRcnn(const StateDict& weights, MaskRcnnConfig config = {});

  std::string name() const override;
  int classes() const override { return box_head_.classes(); }
  bool has_masks() const override { return true; }
  bool has_background() const override { return true; }
  bool has_attention() const { return pyramid_.has_attention(); }

  Precision precision() const { return config_.precision.precision; }

  // The parts that benchmarks time: the extent of an image at the network, P2..P6 of a transformed image
  // (given back when the stem has read it), and the multiply-adds of the convolutions on the way there.
  ImageExtent input_extent(const ByteView& image) const {
    return transformed_extent(image, config_.transform);
  }
  std::array<FeatureMap, kPyramidLevels> pyramid(FeatureMap input, Arena& arena) const {
    return pyramid_(backbone_(std::move(input), arena, pyramid_.input_numbers()), arena,
                    rpn_.input_numbers());
  }
  double pyramid_multiply_adds(int height, int width) const {
    return backbone_.multiply_adds(height, width) + pyramid_.multiply_adds(height, width);
  }

  using InstanceSegmenter::detect;
  void detect(const ByteView& image, Arena& arena, std::vector<Detection>& detections) const override;

 private:
  MaskRcnnConfig config_;
  ResNet backbone_;
  FeaturePyramid pyramid_;
  RegionProposalNetwork rpn_;
  BoxHead box_head_;
  MaskHead mask_head_;
};

}  // namespace penumbra::nn
