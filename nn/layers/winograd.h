// A 3 x 3 convolution of stride 1 with fewer multiplications: Winograd's F(4x4, 3x3).
//
//   Y = A^T [ sum_c (G g_oc G^T) o (B^T d_c B) ] A
//
// for every tile of 4 x 4 output pixels: d_c are the 6 x 6 input pixels of channel c under it, g_oc the 3 x 3
// kernel, o the product element by element. A pair of channels takes 36 multiplications a tile instead of
// 16 * 9 = 144; over the channels, each of the 36 positions is a matrix product, which the register tile
// computes. G g G^T takes 36 / 9 = 4 times the weights' memory, so it is computed anew for each call, or for
// some calls together (prepare): about 130 operations a pair of channels, 2 % of a network's time.
//
// Shapes: those of conv2d.h with K = 3, s = 1, d = 1, G = 1. Cost: 36 C O multiply-adds a tile, and about
// 12 (C + O) additions a pixel for the transforms.
// Where the products are bf16, so are the weights that are kept, and on AVX-512 the maps may be: they are
// widened on the way in and rounded on the way out, a few tiles at a time.
// Error: about 2e-6 of the largest output, 5 times that of the direct sum: intermediate numbers are larger
// than the result. An infinity or NaN spreads over its tile.
// Method: blocks of tiles go through three steps (inputs transformed, multiplied, products transformed), so
// that all a block's numbers stay in the cache. Where there are blocks enough for all threads, each works on
// its own; else all share every block, step by step. The result does not depend on the number of threads.
// Source: Winograd 1980; Lavin and Gray 2016, Fast Algorithms for Convolutional Neural Networks;
// docs/engine/winograd.md. reference/convolution.cpp is the oracle.
#pragma once

#include <vector>

#include "nn/layers/activations.h"
#include "nn/layers/packed_weights.h"
#include "nn/simd/kernel_table.h"
#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

class Winograd {
 public:
  Winograd() = default;
  // `weight` is [O, C, 3, 3], `bias` one value an output channel or empty. `precision`, of
  // the products, is f32 or bf16.
  Winograd(const Tensor& weight, const std::vector<float>& bias, Precision precision = Precision::f32);

  bool empty() const { return input_blocks_ == 0; }
  // In what the map that it reads is best stored; f32 it reads, too.
  Numbers input_numbers() const;
  // Whether its output can be stored so; f32 always.
  bool stores(const Numbers& numbers) const;

  // The transformed weights [position][output tile]..., for calls that follow each other.
  ArenaBuffer prepare(Arena& arena) const;
  // `input`'s border is at least `padding`. Activations other than ReLU are left to the caller. `prepared`
  // comes from prepare().
  void operator()(const FeatureMap& input, int padding, Activation activation, const FeatureMap* residual,
                  FeatureMap& output, Arena& arena, const ArenaBuffer& prepared) const;

 private:
  struct Work;
  std::size_t position_bytes() const;  // from a position's weights to the next one's
  void transform_inputs(const Work& work, int first, int count, int channel_block) const;
  void multiply(const Work& work, int count, int position, int slot) const;
  void transform_outputs(const Work& work, int first, int count, int channel_block) const;

  int input_blocks_ = 0, output_blocks_ = 0;
  WeightMemory kernels_;     // [output tile][C, padded][9][V], f32 or bf16 as the products
  PackedWeights layout_;     // of a position's transformed weights
  std::vector<float> bias_;  // padded to whole blocks
};

// Whether a layer is faster with it. Few channels do not pay for the transforms, very many have so many
// weights that reading them costs more than multiplying.
bool winograd_pays(int channels, int outputs);

}  // namespace penumbra::nn
