// Networks with weights from the counter-based generator: for benchmarks, where only shapes matter, and for
// tests against PyTorch, which is given the same numbers (weights_tools/reference/random_state.py).
#pragma once

#include <functional>
#include <map>
#include <string>

#include "nn/io/state_dict.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

using Shapes = std::map<std::string, Shape>;

// Tensors of these names and shapes; `gain` of a name is about what a layer multiplies its input's size by.
StateDict random_state(const Shapes& shapes, const std::function<double(const std::string&)>& gain);

// All tensors of torchvision's maskrcnn_resnet50_fpn with 91 classes, with mixed attention if wanted.
// `class_gain` multiplies the weights of the class logits: the larger, the surer the network is.
StateDict random_mask_rcnn(bool attention, double class_gain = 1.0);

}  // namespace penumbra::nn
