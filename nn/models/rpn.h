// Region proposal network: class-agnostic boxes that may hold an object.
//
//   t = relu(Conv3x3(P_n));  objectness logits (A a pixel) and box deltas (4 A a pixel) = Conv1x1(t);  A = 3
//   anchors per level: the 1000 best logits -> decode -> clip to the image -> drop sides below 1e-3 -> NMS at
//   0.7 over all levels: the 1000 best sigmoid(logit)
//
// Source: Ren et al. 2015; torchvision.models.detection.rpn.RegionProposalNetwork.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "nn/io/image_transform.h"
#include "nn/layers/box.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/nms.h"
#include "nn/models/fpn.h"
#include "nn/tensor/arena_vector.h"

namespace penumbra::nn {

struct RpnConfig {
  std::array<float, kPyramidLevels> anchor_sizes{32, 64, 128, 256, 512};  // pixels, one a level
  std::array<float, 3> aspect_ratios{0.5F, 1.0F, 2.0F};                   // height / width
  int candidates_per_level = 1000;
  int proposals = 1000;
  float nms_threshold = 0.7F;
  float min_side = 1e-3F;  // pixels
};

class RegionProposalNetwork {
 public:
  RegionProposalNetwork() = default;
  // `channels` are those of the pyramid.
  RegionProposalNetwork(WeightReader& weights, const std::string& prefix, int channels,
                        const RpnConfig& config);

  // In what the pyramid's maps are best stored for the first convolution.
  Numbers input_numbers() const { return conv_.input_numbers(); }

  // Proposals in pixels of the network's input, best first.
  ArenaVector<Box> operator()(std::span<const FeatureMap> pyramid, const ImageExtent& image,
                              Arena& arena) const;

 private:
  // Of a level's logits and deltas, [1, 5 A, H, W], the best ones.
  void add_candidates(const FeatureMap& outputs, std::size_t level, const ImageExtent& image,
                      Candidates& candidates, Arena& arena) const;

  RpnConfig config_;
  Conv2d conv_;
  Conv2d predictor_;  // A logits, then 4 A deltas: one pointwise convolution for both
  std::array<std::vector<Box>, kPyramidLevels> anchors_;
};

}  // namespace penumbra::nn
