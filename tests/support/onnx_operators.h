// One function an ONNX operator, for onnx_layers.cpp: a node, the opset and the inputs give the outputs. They
// throw NotCovered.
#pragma once

#include "tests/support/onnx_layers.h"

namespace penumbra::test {

using Tensors = std::vector<nn::Tensor>;
using Integers = std::vector<std::int64_t>;

inline void require(bool condition, const char* reason) {
  if (!condition) throw NotCovered(reason);
}

Tensors conv(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors conv_transpose(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors max_pool_node(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors average_pool(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors global_average_pool(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors global_max_pool_node(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors resize(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors roi_align_node(const OnnxNode& node, int opset, const Tensors& inputs);
Tensors batch_normalization(const OnnxNode& node, int opset, const Tensors& inputs);

}  // namespace penumbra::test
