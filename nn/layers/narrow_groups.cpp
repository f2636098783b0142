#include "nn/layers/narrow_groups.h"

#include <algorithm>

#include "nn/base/ceil_div.h"

namespace penumbra::nn {

NarrowGroups::NarrowGroups(const Tensor& weight, const std::vector<float>& bias, int groups)
    : group_inputs_(static_cast<int>(weight.extent(1))),
      group_outputs_(static_cast<int>(weight.extent(0)) / groups),
      kernel_height_(static_cast<int>(weight.extent(2))),
      kernel_width_(static_cast<int>(weight.extent(3))) {
  const int outputs = static_cast<int>(weight.extent(0)), blocks = ceil_div(outputs, kBlock);
  for (int b = 0; b < blocks; ++b) {
    for (int k = 0; k < group_inputs_; ++k) {
      for (int u = 0; u < kernel_height_; ++u) {
        for (int v = 0; v < kernel_width_; ++v) {
          for (int o = b * kBlock; o < (b + 1) * kBlock; ++o) {
            weights_.push_back(o < outputs ? weight.at(o, k, u, v) : 0.0F);
          }
        }
      }
    }
  }
  bias_.assign(static_cast<std::size_t>(blocks) * kBlock, 0.0F);
  std::copy(bias.begin(), bias.end(), bias_.begin());
}

void NarrowGroups::row(const FeatureMap& input, int stride, int padding, int dilation, int n, int block,
                       int y, FeatureMap& output) const {
  float* const out = output.pixel(n, block, y, 0);
  const int width = output.width();
  const float* const bias = bias_.data() + static_cast<std::ptrdiff_t>(block) * kBlock;
  for (int x = 0; x < width; ++x) std::copy_n(bias, kBlock, out + static_cast<std::ptrdiff_t>(x) * kBlock);

  const bool depthwise = group_inputs_ == 1 && group_outputs_ == 1;
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(stride) * kBlock;
  const int positions = kernel_height_ * kernel_width_;
  const float* weights =
      weights_.data() + static_cast<std::ptrdiff_t>(block) * group_inputs_ * positions * kBlock;
  for (int k = 0; k < group_inputs_; ++k) {
    std::ptrdiff_t lanes[kBlock];  // offsets of the input channels that the output's lanes read
    for (int l = 0; l < kBlock; ++l) {
      // Lanes beyond the last channel have zero weights; they read any channel that exists.
      const int channel =
          std::min((block * kBlock + l) / group_outputs_ * group_inputs_ + k, input.channels() - 1);
      lanes[l] = channel / kBlock * input.block_stride() + channel % kBlock;
    }
    for (int u = 0; u < kernel_height_; ++u) {
      for (int v = 0; v < kernel_width_; ++v, weights += kBlock) {
        const float* in = input.pixel(n, depthwise ? block : 0, y * stride - padding + u * dilation,
                                      v * dilation - padding);
        if (depthwise) {
          for (int x = 0; x < width; ++x) {
            for (int l = 0; l < kBlock; ++l) out[x * kBlock + l] += weights[l] * in[x * step + l];
          }
        } else {
          for (int x = 0; x < width; ++x) {
            for (int l = 0; l < kBlock; ++l) out[x * kBlock + l] += weights[l] * in[x * step + lanes[l]];
          }
        }
      }
    }
  }
}

}  // namespace penumbra::nn
