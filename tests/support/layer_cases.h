// The cases of tests/fixtures/layers: what PyTorch's layers gave for inputs from the counter-based generator.
// weights_tools/reference/make_layer_fixtures.py writes them and says how the inputs are made.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "nn/layers/activations.h"
#include "nn/layers/box.h"
#include "nn/tensor/tensor.h"

namespace penumbra::test {

struct LayerCase {
  int index = 0;
  nlohmann::json options;  // of the layer, "layer" and "inputs" among them
  nn::Tensor expected;

  std::string layer() const { return options.at("layer").get<std::string>(); }
  template <class T>
  T option(const char* name, T otherwise) const {
    return options.value(name, otherwise);
  }
  template <class T = int>
  T option(const char* name) const {
    return options.at(name).get<T>();
  }
  nn::Activation activation() const;
  float slope() const { return option("slope", nn::kDefaultSlope); }

  // Input `name`, in [-1, 1); has() says whether the case has it.
  bool has(const std::string& name) const;
  nn::Tensor input(const std::string& name) const;
  // The values of input `name`, none where the case has no such input.
  std::vector<float> values(const std::string& name) const;
  // Input `name`, [R, 4], as boxes of up to 40 pixels in and around an image of 60 x 60.
  std::vector<nn::Box> boxes(const std::string& name) const;
};

std::vector<LayerCase> layer_cases();

}  // namespace penumbra::test
