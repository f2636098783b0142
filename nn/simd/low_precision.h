// Kernels that multiply bf16 or 8-bit numbers, and which of them this machine can run.
//
// Two kinds of them: on a tile unit (tile_unit.h), whose layers read and write narrow maps; and on vector
// registers, in the register tile of kernel_table.h, whose inputs are converted and whose outputs are f32.
// (Around these Winograd's layers read and write maps in bf16, too, on AVX-512: winograd.h.) Sums are f32 or
// 32-bit whole numbers. numbers.h says what the numbers are.
// See docs/engine/quantisation.md.
#pragma once

#include <cstddef>
#include <string_view>

#include "nn/simd/kernel_table.h"
#include "nn/simd/numbers.h"

namespace penumbra::nn {

const char* to_string(Precision precision);
// Throws UsageError for a name that is none of f32, bf16, int8.
Precision precision_from_name(std::string_view name);

// f32 always; the others where the instruction set in use has them: a tile unit, AVX-512 with the BF16 and
// VNNI extensions, neon_bf16; neon_dot has int8 alone.
bool is_supported(Precision precision);
// Throws UsageError that names what the processor lacks.
void require(Precision precision);

struct LowPrecisionKernels {
  TileKernels tile;
  // `count` values, a multiple of 16, as the numbers that the tile reads; int8 alone looks at `quantisation`.
  void (*convert)(const float* values, std::ptrdiff_t count, const Quantisation& quantisation, void* out);
};

// How bf16 is best multiplied here. VDPBF16PS does twice the multiply-adds of an instruction in f32; AMD's
// processors run both at one rate, Intel's run it at half the other's, where f32 is faster: its inputs need
// no conversion and Winograd no rounding. Networks asked for bf16 take f32 there (layer_precision.h). BFMMLA
// does four times as many and is taken without a measurement.
enum class Bf16Arithmetic { tiles, dot_products, f32 };
const char* to_string(Bf16Arithmetic arithmetic);
// The faster one. On x86-64 without a tile unit, the first call measures both for less than a millisecond:
// one takes half the other's time or neither does, so every run of a machine chooses the same. Throws as
// require() does.
Bf16Arithmetic bf16_arithmetic();
// For tests: dot_products or f32, for networks that are built from now on.
void use_bf16_arithmetic(Bf16Arithmetic arithmetic);

// The kernels of a precision that is_supported, not of f32. With a tile unit it has the weights' width alone:
// whole layers are its work, no single tiles.
const LowPrecisionKernels& low_precision_kernels(Precision precision);

namespace avx512_low {
extern const LowPrecisionKernels kBf16Kernels, kInt8Kernels;
}
namespace neon_dot {
extern const LowPrecisionKernels kInt8Kernels;
}
namespace neon_bf16 {
extern const LowPrecisionKernels kBf16Kernels, kInt8Kernels;
}

}  // namespace penumbra::nn
