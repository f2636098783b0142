#include "nn/models/weight_reader.h"

#include <fmt/ranges.h>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

// PyTorch's own counter of training steps; inference has no use for it.
bool is_counter(const std::string& name) { return name.ends_with("num_batches_tracked"); }

}  // namespace

Shape WeightReader::shape(const std::string& name) const {
  const auto found = state_dict_.tensors.find(name);
  return found == state_dict_.tensors.end() ? Shape{} : found->second.shape;
}

Tensor WeightReader::tensor(const std::string& name, const Shape& shape) {
  const auto found = state_dict_.tensors.find(name);
  if (found == state_dict_.tensors.end()) {
    problems_.push_back(fmt::format("missing {} {}", name, to_string(shape)));
    return Tensor(shape);
  }
  used_.insert(name);
  if (found->second.shape != shape) {
    problems_.push_back(fmt::format("{}: expected shape {}, found {}", name, to_string(shape),
                                    to_string(found->second.shape)));
    return Tensor(shape);
  }
  return {shape, found->second.to_f32()};
}

BatchNorm WeightReader::batch_norm(const std::string& name, std::int64_t channels, float eps) {
  return {vector(name + ".weight", channels), vector(name + ".bias", channels),
          vector(name + ".running_mean", channels), vector(name + ".running_var", channels), eps};
}

void WeightReader::ignore(const std::string& prefix) {
  for (const auto& [name, tensor] : state_dict_.tensors) {
    if (name.starts_with(prefix)) used_.insert(name);
  }
}

void WeightReader::finish(const std::string& network) const {
  std::vector<std::string> problems = problems_;
  for (const auto& [name, tensor] : state_dict_.tensors) {
    if (!used_.contains(name) && !is_counter(name)) {
      problems.push_back(fmt::format("not part of the network: {} {}", name, to_string(tensor.shape)));
    }
  }
  if (problems.empty()) return;
  throw InputError(state_dict_.source, fmt::format("the weights of {}", network),
                   fmt::format("{} that do not fit:\n  {}", problems.size(), fmt::join(problems, "\n  ")));
}

}  // namespace penumbra::nn
