// YOLOv5 (releases 6 and 7), detection or instance segmentation: image in, object instances out.
//
//   image -> letterbox -> backbone and neck (N3, N4, N5) -> heads -> NMS per class -> masks on the image
//
// AFNET is the same network with coordinate attention in the backbone (yolov5_blocks.h) and ASFF before the
// heads (yolov5_fusion.h); the weights' names say which of the two they have.
//
// The weights decide width, depth, the number of classes, the anchors and whether there are masks; batch norm
// may be folded into them or not. Networks of 80 classes are taken for COCO's: their labels are COCO's
// category numbers (1..90, with gaps); of others, label = the network's class + 1. Source: Jocher et al.,
// YOLOv5 7.0; Xu et al. 2023 (AFNET; docs/papers.md B.1); weights_tools/reference/yolov5.py and afnet.py are
// the oracles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nn/io/letterbox.h"
#include "nn/models/instance_segmenter.h"
#include "nn/models/layer_precision.h"
#include "nn/models/yolov5_features.h"
#include "nn/models/yolov5_fusion.h"
#include "nn/models/yolov5_head.h"

namespace penumbra::nn {

struct Yolov5Config {
  Letterbox letterbox;          // its size: where neither the weights nor the user name one
  std::optional<int> max_size;  // of the user, in place of the weights' own
  // 0.001 and 300 detections find the last thousandths of average precision, 0.25 gives a clean picture.
  float score_threshold = 0.02F;
  float nms_threshold = 0.6F;
  int max_candidates = 30000;  // the best ones take part in NMS
  int max_detections = 100;
  float mask_threshold = 0.5F;
  LayerPrecision precision;
};

class Yolov5 : public InstanceSegmenter {
 public:
  // Throws InputError that lists every tensor that is missing, mis-shaped or not part of the network.
  explicit Yolov5(const StateDict& weights, Yolov5Config config = {});

  std::string name() const override { return shape_.name(); }
  int classes() const override;
  bool has_masks() const override { return head_.has_masks(); }
  bool has_background() const override { return false; }
  const Yolov5Shape& shape() const { return shape_; }
  int longest_side() const { return config_.letterbox.size; }  // of images at the network, pixels

  using InstanceSegmenter::detect;
  void detect(const ByteView& image, Arena& arena, std::vector<Detection>& detections) const override;

  // The network alone, without what comes before and after. `image` is [1, 3, H, W] in blocks of 4, extents
  // multiples of 32.
  Yolov5Output forward(FeatureMap image, Arena& arena) const;
  const Yolov5Head& head() const { return head_; }

 private:
  ArenaVector<Yolov5Candidate> best_candidates(const Yolov5Output& output, Arena& arena) const;

  Yolov5Config config_;
  Yolov5Shape shape_;
  Yolov5Features features_;
  Yolov5Fusion fusion_;
  Yolov5Head head_;
};

}  // namespace penumbra::nn
