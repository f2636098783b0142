// Mask head: a 28 x 28 probability map for each detection, of its own class only.
//
//   m = relu(ConvTranspose2x2(f)),  f = four times (or `layers` times) relu(Conv3x3) of RoIAlign_14x14(P,
//   box) probabilities = sigmoid(w_label . m + b_label)
//
// The last layer has one output a class; only the detection's class is computed: one multiply-add a channel
// and pixel, not one a class. Source: He et al. 2017, Mask R-CNN, figure 4 right;
// torchvision.models.detection.mask_rcnn.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "nn/layers/conv2d.h"
#include "nn/layers/conv_transpose2d.h"
#include "nn/models/box_head.h"

namespace penumbra::nn {

struct MaskHeadConfig {
  static constexpr int kMostLayers = 8;
  int layers = 4;  // 3 x 3 convolutions
  RoiAlignOptions roi_align{14, 2};
};

class MaskHead {
 public:
  MaskHead() = default;
  // `channels` are those of the pyramid.
  MaskHead(WeightReader& weights, const std::string& prefix, int channels, int classes,
           const MaskHeadConfig& config);

  int mask_size() const { return 2 * config_.roi_align.size; }  // 28

  // For every detection mask_size^2 probabilities, row-major, one after the other.
  ArenaVector<float> operator()(std::span<const PyramidLevel> pyramid,
                                const ArenaVector<ScoredBox>& detections, Arena& arena) const;

 private:
  using PreparedLayers = std::array<ArenaBuffer, MaskHeadConfig::kMostLayers>;
  // Appends those of the detections, at most `capacity` of them.
  void predict(std::span<const PyramidLevel> pyramid, std::span<const ScoredBox> detections, int capacity,
               const PreparedLayers& prepared, ArenaVector<float>& probabilities, Arena& arena) const;

  MaskHeadConfig config_;
  std::vector<Conv2d> convolutions_;
  ConvTranspose2d upsample_;
  Tensor logit_weight_;            // [classes, channels, 1, 1]
  std::vector<float> logit_bias_;  // [classes]
};

}  // namespace penumbra::nn
