// The naive version of every layer: the formula of the layer's own header, loop by loop, on plain [N, C, H,
// W] tensors, sums in double. Slow on purpose; the oracle of the fast versions.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "nn/layers/activations.h"
#include "nn/layers/batch_norm.h"
#include "nn/layers/box.h"
#include "nn/layers/conv2d.h"
#include "nn/layers/conv_transpose2d.h"
#include "nn/layers/coordinate_attention.h"
#include "nn/layers/mask_paste.h"
#include "nn/layers/pooling.h"
#include "nn/layers/prototype_mask.h"
#include "nn/layers/roi_align.h"
#include "nn/layers/self_attention.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn::reference {

inline double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// See nn/layers/conv2d.h; `bias` empty and `residual` null for none.
Tensor conv2d(const Tensor& x, const Tensor& weight, const std::vector<float>& bias,
              const Conv2dOptions& options, const Tensor* residual = nullptr);
// W x + b over x [N, I], W [O, I]; gives [N, O].
Tensor linear(const Tensor& x, const Tensor& weight, const std::vector<float>& bias, Activation activation);
// See nn/layers/conv_transpose2d.h.
Tensor conv_transpose2d(const Tensor& x, const Tensor& weight, const std::vector<float>& bias,
                        const ConvTranspose2dOptions& options);
// (z - mean) / sqrt(var + eps) gamma + beta, a channel at a time; see nn/layers/batch_norm.h.
Tensor batch_norm(const Tensor& x, const BatchNorm& norm);
// See nn/layers/activations.h.
double activate(double x, Activation activation, float slope);
Tensor activate(const Tensor& x, Activation activation, float slope = kDefaultSlope);
Tensor softmax_channels(const Tensor& x);
// See nn/layers/concat.h.
Tensor concat(std::span<const Tensor> parts);
Tensor slice_channels(const Tensor& x, std::int64_t first, std::int64_t count);
// y + x and y x, x broadcast to y; see nn/layers/elementwise.h.
Tensor add(const Tensor& y, const Tensor& x);
Tensor multiply(const Tensor& y, const Tensor& x);
// See nn/layers/pooling.h.
Tensor max_pool(const Tensor& x, const PoolOptions& options);
Tensor avg_pool(const Tensor& x, const PoolOptions& options, bool count_padding);
Tensor adaptive_avg_pool(const Tensor& x, std::int64_t height, std::int64_t width);
Tensor adaptive_max_pool(const Tensor& x, std::int64_t height, std::int64_t width);
Tensor global_avg_pool(const Tensor& x);
Tensor global_max_pool(const Tensor& x);
// See nn/layers/upsample.h; add_upsampled is y + nearest-upsampled x.
Tensor upsample_nearest(const Tensor& x, std::int64_t height, std::int64_t width);
Tensor add_upsampled(const Tensor& x, const Tensor& y);
Tensor upsample_bilinear(const Tensor& x, std::int64_t height, std::int64_t width, bool align_corners);
// See nn/layers/spatial_attention.h and channel_attention.h.
Tensor spatial_attention(const Tensor& x, const Tensor& weight);
Tensor channel_attention(const Tensor& x, const Tensor& reduce, const Tensor& expand);
Tensor mixed_attention(const Tensor& x, const Tensor& spatial, const Tensor& reduce, const Tensor& expand);
// See nn/layers/coordinate_attention.h, asff.h and self_attention.h.
Tensor coordinate_attention(const Tensor& x, const CoordinateAttentionWeights& weights);
Tensor asff(std::span<const Tensor> levels, std::span<const Tensor> weights, const std::vector<float>& bias);
Tensor self_attention(const Tensor& x, const SelfAttentionWeights& weights);
// One level of nn/layers/roi_align.h: every region is read from `map` [1, C, H, W] at `scale`.
Tensor roi_align(const Tensor& map, float scale, std::span<const Box> regions,
                 const RoiAlignOptions& options);
// See nn/layers/nms.h.
std::vector<int> batched_nms(std::span<const Box> boxes, std::span<const float> scores,
                             std::span<const int> groups, float threshold, int max_kept);
// See nn/layers/mask_paste.h; the whole image's mask, row-major, 0 or 1.
std::vector<std::uint8_t> paste_mask(std::span<const float> probabilities, int size, const Box& box,
                                     int image_width, int image_height, float threshold);
// See nn/layers/prototype_mask.h; the whole image's mask, row-major, 0 or 1.
std::vector<std::uint8_t> prototype_mask(const Tensor& prototypes, std::span<const float> weights,
                                         const PrototypeFrame& frame, const Box& box, int image_width,
                                         int image_height, float threshold);

}  // namespace penumbra::nn::reference
