#include "nn/layers/batch_norm.h"

#include <cmath>
#include <utility>

namespace penumbra::nn {

FoldedConvolution fold_batch_norm(Tensor weight, const BatchNorm& norm) {
  const std::size_t outputs = norm.gamma.size();
  const std::size_t row = outputs == 0 ? 0 : weight.values.size() / outputs;
  FoldedConvolution folded{std::move(weight), std::vector<float>(outputs)};
  for (std::size_t o = 0; o < outputs; ++o) {
    const float scale = norm.gamma[o] / std::sqrt(norm.variance[o] + norm.eps);
    for (std::size_t i = 0; i < row; ++i) folded.weight.values[o * row + i] *= scale;
    folded.bias[o] = norm.beta[o] - norm.mean[o] * scale;
  }
  return folded;
}

}  // namespace penumbra::nn
