// Kernels that multiply bf16 or 8-bit numbers, and which of them this machine can run.
//
//   bf16   the upper half of an f32: its exponent, 8 bits of its mantissa; rounded to nearest, ties to even
//   int8   inputs x = scale (q - zero) with q in 0..255, weights w = scale_o q_w with q_w in -127..127
//
// Sums are f32 or 32-bit whole numbers; what the tiles read is converted, what they write is f32.
// See docs/engine/quantisation.md.
#pragma once

#include <cstddef>
#include <string_view>

#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

enum class Precision { f32, bf16, int8 };

const char* to_string(Precision precision);
// Throws UsageError for a name that is none of f32, bf16, int8.
Precision precision_from_name(std::string_view name);

// f32 always; the others where the processor has the instructions and the widest instruction set is in use.
bool is_supported(Precision precision);
// Throws UsageError that names what the processor lacks.
void require(Precision precision);

// Of one layer's inputs.
struct Quantisation {
  float scale = 1.0F;
  int zero = 0;
};

struct LowPrecisionKernels {
  TileKernels tile;
  // `count` values, a multiple of 16, as the numbers that the tile reads; int8 alone looks at `quantisation`.
  void (*convert)(const float* values, std::ptrdiff_t count, const Quantisation& quantisation, void* out);
};

// The kernels of a precision that is_supported, not of f32.
const LowPrecisionKernels& low_precision_kernels(Precision precision);
// Bytes of an input or weight.
int element_size(Precision precision);
// Channels that one instruction adds up in one lane: the innermost extent of packed weights.
int channel_group(Precision precision);

namespace avx512_low {
extern const LowPrecisionKernels kBf16Kernels, kInt8Kernels;
}

}  // namespace penumbra::nn
