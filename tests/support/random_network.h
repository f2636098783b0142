// Networks with weights from the counter-based generator, and images made from it: what
// weights_tools/reference/make_*_fixtures.py give PyTorch, number for number.
#pragma once

#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <string>

#include "nn/io/state_dict.h"
#include "nn/tensor/tensor.h"

namespace penumbra::test {

using Shapes = std::map<std::string, nn::Shape>;

// Tensors of these names and shapes; `gain` of a name is about what a layer multiplies its input's size by.
// See weights_tools/reference/random_state.py.
nn::StateDict random_state(const Shapes& shapes, const std::function<double(const std::string&)>& gain);

// All tensors of torchvision's maskrcnn_resnet50_fpn with 91 classes, with mixed attention if wanted.
nn::StateDict random_mask_rcnn(bool attention);

// Blocks of random colour, 8 x 8 pixels each, and noise; BGR.
cv::Mat random_image(std::uint32_t seed, int width, int height);

}  // namespace penumbra::test
