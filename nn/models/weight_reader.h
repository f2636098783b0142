// Hands a network its tensors by torchvision's state-dict names and keeps a list of what is wrong, so that
// one error names every missing, mis-shaped, damaged and unused tensor at once.
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
      : state_dict_(state_dict), precision_(precision.resolved(state_dict)) {}

  const std::string& source() const { return state_dict_.source; }  // the file, for messages
  bool has(const std::string& name) const { return state_dict_.tensors.contains(name); }
  // Shape of a tensor, or an empty shape where there is none; for sizes that the weights decide (classes).
  Shape shape(const std::string& name) const;

  // The tensor as f32. Where it is missing or of another shape, notes that and returns zeros of `shape`; a
  // NaN or an infinite number in it is noted, too.
  Tensor tensor(const std::string& name, const Shape& shape);
  std::vector<float> vector(const std::string& name, std::int64_t size) {
    return tensor(name, {size}).values;
  }
  // `convolution`.weight, of this shape, with the batch norm `norm`.weight, .bias, .running_mean and
  // .running_var folded into it, in f32. Notes a channel whose variance + eps is not positive, and weights
  // that folding made infinite.
  FoldedConvolution folded(const std::string& convolution, const Shape& shape, const std::string& norm,
                           float eps);

  // The numbers in which the layer of this name multiplies: see layer_precision.h. Throws InputError where
  // int8 is asked for and the weights were not calibrated.
  NumberFormat format(const std::string& layer) const { return precision_.format(state_dict_, layer); }
  const LayerPrecision& precision() const { return precision_; }
  NumberFormat uncalibrated_format() const { return precision_.uncalibrated_format(); }

  // Epsilon of the batch norms: the weights' metadata "batch_norm_eps", else `usual`. Throws InputError where
  // it is no number in 0..1.
  float batch_norm_eps(float usual) const;
  // Notes metadata of another value than the network is built for; their absence is none.
  void expect_metadata(const std::string& key, const std::string& value);

  // Marks every tensor whose name starts with `prefix` as read: tensors that a network may carry but does not
  // use.
  void ignore(const std::string& prefix);

  // The last call, when the network is built. Throws InputError unless every tensor asked for was there, with
  // finite numbers, and every tensor there was asked for; `network` names what was built, for the message.
  // Gives the memory that tensors took on their way back to the system.
  void finish(const std::string& network) const;

 private:
  void check_variance(const std::string& name, const BatchNorm& norm);

  const StateDict& state_dict_;
  LayerPrecision precision_;
  std::set<std::string> used_;
  std::vector<std::string> problems_;
};

}  // namespace penumbra::nn
