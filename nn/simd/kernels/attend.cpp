// What a pixel takes from all pixels of a map by self-attention: kernel_table.h says what it computes.

#include <limits>

#include "nn/simd/exponential.h"
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

void score(const AttendArguments& a) {
  for (std::ptrdiff_t i = 0; i < a.key_stride; i += kLanes) {
    Vector sum(0.0F);
    for (int d = 0; d < a.depth; ++d) {
      const float q = a.query[(d / kBlockLanes) * a.query_block_stride + d % kBlockLanes];
      sum = madd(Vector(q), Vector::load_unaligned(a.keys + d * a.key_stride + i), sum);
    }
    sum.store_unaligned(a.scores + i);
  }
}

float largest(const float* scores, std::ptrdiff_t count) {
  Vector top(-std::numeric_limits<float>::max());
  for (std::ptrdiff_t i = 0; i < count; i += kLanes) top = max(top, Vector::load_unaligned(scores + i));
  float lanes[kLanes];
  top.store_unaligned(lanes);
  float result = lanes[0];
  for (const float lane : lanes) result = lane > result ? lane : result;
  return result;
}

float sum_of(const float* scores, std::ptrdiff_t count) {
  Vector sum(0.0F);
  for (std::ptrdiff_t i = 0; i < count; i += kLanes) sum = sum + Vector::load_unaligned(scores + i);
  return hadd(sum);
}

// out[c] += factor sum_i scores[i] value[16 i + c] for a block of channels.
void add_weighted(const AttendArguments& a, const float* value, float factor, float* out) {
  constexpr std::ptrdiff_t kRun = 256;  // sums of runs keep the rounding error of a large map small
  constexpr int kChains = kBlockVectors == 4 ? 2 : 4;  // sums that do not wait for each other
  Vector sum[kBlockVectors];
  for (auto& s : sum) s = Vector(0.0F);
  for (std::ptrdiff_t first = 0; first < a.pixels; first += kRun) {
    const std::ptrdiff_t end = first + kRun < a.pixels ? first + kRun : a.pixels;
    Vector run[kChains][kBlockVectors];
    for (auto& chain : run) {
      for (auto& s : chain) s = Vector(0.0F);
    }
    std::ptrdiff_t i = first;
    for (; i + kChains <= end; i += kChains) {
      for (int j = 0; j < kChains; ++j) {
        const Vector weight(a.scores[i + j]);
        for (int k = 0; k < kBlockVectors; ++k) {
          run[j][k] =
              madd(weight, Vector::load_unaligned(value + (i + j) * kBlockLanes + k * kLanes), run[j][k]);
        }
      }
    }
    for (; i < end; ++i) {
      const Vector weight(a.scores[i]);
      for (int k = 0; k < kBlockVectors; ++k)
        run[0][k] = madd(weight, Vector::load_unaligned(value + i * kBlockLanes + k * kLanes), run[0][k]);
    }
    for (int k = 0; k < kBlockVectors; ++k) {
      for (int j = 1; j < kChains; ++j) run[0][k] = run[0][k] + run[j][k];
      sum[k] = sum[k] + run[0][k];
    }
  }
  for (int k = 0; k < kBlockVectors; ++k) {
    madd(Vector(factor), sum[k], Vector::load_unaligned(out + k * kLanes)).store_unaligned(out + k * kLanes);
  }
}

}  // namespace

void attend(const AttendArguments& a) {
  score(a);
  for (std::ptrdiff_t i = a.pixels; i < a.key_stride; ++i) a.scores[i] = -std::numeric_limits<float>::max();
  const float top = largest(a.scores, a.key_stride);
  for (std::ptrdiff_t i = 0; i < a.key_stride; ++i) a.scores[i] = exponential(a.scores[i] - top);
  for (std::ptrdiff_t i = a.pixels; i < a.key_stride; ++i) a.scores[i] = 0.0F;
  const float factor = a.factor / sum_of(a.scores, a.key_stride);
  for (int b = 0; b < a.blocks; ++b)
    add_weighted(a, a.values + b * a.value_block_stride, factor, a.output + b * a.output_block_stride);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
