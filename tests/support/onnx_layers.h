// ONNX's operators on the engine's layers, as far as the two mean the same.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "nn/tensor/tensor.h"
#include "tests/support/onnx.h"

namespace penumbra::test {

// The layers cannot do what a node asks for; what() says why.
class NotCovered : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Whether some layer computes this operator.
bool is_covered(const std::string& operation);

// The node's outputs for its inputs, in order; an empty shape and no values for an input that is left out.
// Throws NotCovered.
std::vector<nn::Tensor> run_onnx_node(const OnnxNode& node, int opset, const std::vector<nn::Tensor>& inputs);

}  // namespace penumbra::test
