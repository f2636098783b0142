// Hands a network its tensors by torchvision's state-dict names and keeps a list of what is wrong, so that
// one error names every missing, mis-shaped and unused tensor at once.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "nn/io/state_dict.h"
#include "nn/layers/batch_norm.h"
#include "nn/models/layer_precision.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

class WeightReader {
 public:
  explicit WeightReader(const StateDict& state_dict, LayerPrecision precision = {})
      : state_dict_(state_dict), precision_(precision) {}

  const std::string& source() const { return state_dict_.source; }  // the file, for messages
  bool has(const std::string& name) const { return state_dict_.tensors.contains(name); }
  // Shape of a tensor, or an empty shape where there is none; for sizes that the weights decide (classes).
  Shape shape(const std::string& name) const;

  // The tensor as f32. Where it is missing or of another shape, notes that and returns zeros of `shape`.
  Tensor tensor(const std::string& name, const Shape& shape);
  std::vector<float> vector(const std::string& name, std::int64_t size) {
    return tensor(name, {size}).values;
  }
  // `name`.weight, .bias, .running_mean and .running_var.
  BatchNorm batch_norm(const std::string& name, std::int64_t channels, float eps);

  // The numbers in which the layer of this name multiplies: see layer_precision.h. Throws InputError where
  // int8 is asked for and the weights were not calibrated.
  NumberFormat format(const std::string& layer) const { return precision_.format(state_dict_, layer); }

  // Marks every tensor whose name starts with `prefix` as read: tensors that a network may carry but does not
  // use.
  void ignore(const std::string& prefix);

  // Throws InputError unless every tensor asked for was there and every tensor there was asked for.
  // `network` names what was built, for the message.
  void finish(const std::string& network) const;

 private:
  const StateDict& state_dict_;
  LayerPrecision precision_;
  std::set<std::string> used_;
  std::vector<std::string> problems_;
};

}  // namespace penumbra::nn
