// A row of a mixture of feature maps with shares of their own at every pixel: kernel_table.h says what it
// computes.

#include "nn/simd/exponential.h"
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

// w . f over the channels of a pixel.
float dot(const MixedLevel& level, const float* f, int blocks) {
  Vector sum[kBlockVectors];
  for (auto& s : sum) s = Vector(0.0F);
  const float* w = level.weights;
  for (int b = 0; b < blocks; ++b, f += level.block_stride, w += kBlockLanes) {
    for (int k = 0; k < kBlockVectors; ++k) {
      const int c = k * kLanes;
      sum[k] = madd(Vector::load_unaligned(w + c), Vector::load_unaligned(f + c), sum[k]);
    }
  }
  for (int k = 1; k < kBlockVectors; ++k) sum[0] = sum[0] + sum[k];
  return hadd(sum[0]);
}

// lambda of a level, each as often as its pixel is repeated.
void lambda_row(const MixedLevel& level, int width, int blocks, float* lambda) {
  const float* f = level.row;
  for (int x = 0; x < width; x += level.factor, f += kBlockLanes) {
    const float value = level.bias + dot(level, f, blocks);
    for (int r = 0; r < level.factor; ++r) lambda[x + r] = value;
  }
}

void softmax_of_levels(float* shares, int level_count, int width) {
  for (int x = 0; x < width; ++x) {
    float top = shares[x];
    for (int k = 1; k < level_count; ++k) {
      const float lambda = shares[k * width + x];
      top = lambda > top ? lambda : top;
    }
    float sum = 0.0F;
    for (int k = 0; k < level_count; ++k) {
      const float share = exponential(shares[k * width + x] - top);
      shares[k * width + x] = share;
      sum += share;
    }
    for (int k = 0; k < level_count; ++k) shares[k * width + x] /= sum;
  }
}

// Adds a level's part to block b of the row, or begins with it.
void add_level(const MixedLevel& level, const float* shares, int width, int b, bool first, float* out) {
  const float* f = level.row + b * level.block_stride;
  for (int x = 0; x < width; f += kBlockLanes) {
    for (int r = 0; r < level.factor; ++r, ++x, out += kBlockLanes) {
      const Vector share(shares[x]);
      for (int k = 0; k < kBlockVectors; ++k) {
        const int c = k * kLanes;
        const Vector value = Vector::load_unaligned(f + c);
        (first ? share * value : madd(share, value, Vector::load_unaligned(out + c)))
            .store_unaligned(out + c);
      }
    }
  }
}

}  // namespace

void mix_row(const MixRowArguments& a) {
  for (int k = 0; k < a.level_count; ++k) {
    lambda_row(a.levels[k], a.width, a.blocks, a.shares + k * a.width);
  }
  softmax_of_levels(a.shares, a.level_count, a.width);
  for (int b = 0; b < a.blocks; ++b) {
    float* out = a.output + b * a.output_block_stride;
    for (int k = 0; k < a.level_count; ++k) {
      add_level(a.levels[k], a.shares + k * a.width, a.width, b, k == 0, out);
    }
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
