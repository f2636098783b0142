#include "nn/models/weight_reader.h"

#include <fmt/ranges.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/models/weight_metadata.h"

namespace penumbra::nn {

namespace {

// PyTorch's own counter of training steps; inference has no use for it.
bool is_counter(const std::string& name) { return name.ends_with("num_batches_tracked"); }

// "nan at index 5, 3 of 64" for values that are not all finite.
std::optional<std::string> describe_not_finite(const std::vector<float>& values) {
  // Without a branch, so that the common case is fast.
  std::size_t count = 0;
  for (const float value : values) count += std::abs(value) <= std::numeric_limits<float>::max() ? 0 : 1;
  if (count == 0) return std::nullopt;
  const auto first =
      std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
  return fmt::format("{} at index {}, {} of {}", *first, first - values.begin(), count, values.size());
}

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
  if (!has_f32_values(found->second.type)) {
    problems_.push_back(
        fmt::format("{}: expected real numbers, found {}", name, to_string(found->second.type)));
    return Tensor(shape);
  }
  Tensor tensor{shape, found->second.to_f32()};
  state_dict_.forget(found->second);
  if (const auto problem = describe_not_finite(tensor.values)) {
    problems_.push_back(fmt::format("{}: expected finite numbers, found {}", name, *problem));
  }
  return tensor;
}

FoldedConvolution WeightReader::folded(const std::string& convolution, const Shape& shape,
                                       const std::string& norm, float eps) {
  const std::size_t problems = problems_.size();
  const std::int64_t channels = shape.front();
  Tensor weight = tensor(convolution + ".weight", shape);
  const BatchNorm batch_norm{vector(norm + ".weight", channels), vector(norm + ".bias", channels),
                             vector(norm + ".running_mean", channels),
                             vector(norm + ".running_var", channels), eps};
  if (problems_.size() == problems) check_variance(norm + ".running_var", batch_norm);
  FoldedConvolution folded = fold_batch_norm(std::move(weight), batch_norm);
  if (problems_.size() > problems) return folded;  // the cause is named already
  auto problem = describe_not_finite(folded.weight.values);
  if (!problem) problem = describe_not_finite(folded.bias);
  if (problem) {
    problems_.push_back(
        fmt::format("{}.weight: expected finite numbers with the batch norm {} folded, found {}", convolution,
                    norm, *problem));
  }
  return folded;
}

void WeightReader::check_variance(const std::string& name, const BatchNorm& norm) {
  for (std::size_t channel = 0; channel < norm.variance.size(); ++channel) {
    const float variance = norm.variance[channel];
    if (variance + norm.eps > 0.0F) continue;
    problems_.push_back(fmt::format(
        "{}: expected a variance + batch_norm_eps above 0, found {} + {} in channel {}{}", name, variance,
        norm.eps, channel,
        variance == 0.0F ? " (rounded to 0 when it was stored in 16 bits, or another epsilon?)" : ""));
    return;
  }
}

float WeightReader::batch_norm_eps(float usual) const {
  return static_cast<float>(metadata_number(state_dict_, "batch_norm_eps", {0.0, 1.0}).value_or(usual));
}

void WeightReader::expect_metadata(const std::string& key, const std::string& value) {
  const auto found = state_dict_.metadata.find(key);
  if (found == state_dict_.metadata.end() || found->second == value) return;
  problems_.push_back(
      fmt::format("metadata {}: expected {}, found {}", key, value, printable(found->second)));
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
  if (problems.empty()) {
#if defined(__GLIBC__)
    malloc_trim(0);  // the tensors that were read have left tens of MB in the heap
#endif
    return;
  }
  constexpr std::size_t kMostListed = 10;
  const std::size_t count = problems.size();
  if (count > kMostListed) {
    problems.resize(kMostListed);
    problems.push_back(fmt::format("and {} more", count - kMostListed));
  }
  throw InputError(state_dict_.source, fmt::format("the weights of {}", network),
                   fmt::format("{} that do not fit:\n  {}", count, fmt::join(problems, "\n  ")));
}

}  // namespace penumbra::nn
