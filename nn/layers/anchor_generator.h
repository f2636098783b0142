// Anchors: the reference boxes of a region proposal network.
//
// A level has one scale s (pixels) and ratios r = h / w. Its base anchors, centred on (0, 0), have
//   w = s / sqrt(r), h = s sqrt(r), corners rounded to whole pixels (half to even);
// position (i, j) of the level's map shifts them by (j stride_x, i stride_y), stride = floor(image size / map
// size) of the padded image. Source: Ren et al. 2015, Faster R-CNN, section 3.1.1;
// torchvision.models.detection.anchor_utils.AnchorGenerator.
#pragma once

#include <span>
#include <vector>

#include "nn/layers/box.h"

namespace penumbra::nn {

// One base anchor a ratio.
std::vector<Box> base_anchors(float scale, std::span<const float> ratios);

inline Box shift(const Box& box, float dx, float dy) {
  return {box.x1 + dx, box.y1 + dy, box.x2 + dx, box.y2 + dy};
}

}  // namespace penumbra::nn
