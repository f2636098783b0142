// A Mask R-CNN with weights from the counter-based generator, and images made from it: what
// weights_tools/reference/make_mask_rcnn_fixtures.py gives torchvision, number for number.
#pragma once

#include <opencv2/core.hpp>

#include "nn/io/state_dict.h"
#include "nn/tensor/tensor.h"

namespace penumbra::test {

// All tensors of torchvision's maskrcnn_resnet50_fpn with 91 classes, with mixed attention if wanted.
nn::StateDict random_mask_rcnn(bool attention);

// Blocks of random colour, 8 x 8 pixels each, and noise; BGR.
cv::Mat random_image(std::uint32_t seed, int width, int height);

}  // namespace penumbra::test
