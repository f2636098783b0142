// Instruction sets that the vector kernels are compiled for, and the one that this machine gets.
#pragma once

#include <string_view>

namespace penumbra::nn {

enum class Isa {
  baseline,  // x86-64-v2: SSE4.2, 4 floats a vector
  avx2,      // x86-64-v3: AVX2 and FMA, 8 floats
  avx512,    // x86-64-v4: AVX-512 F BW CD DQ VL, 16 floats
  amx,       // avx512, and the tile unit for bf16 and int8 (tile_unit.h)
  // The widest of the first three, and a tile unit in software: slow, for tests on machines without one.
  amx_emulated,
};

const char* to_string(Isa isa);
// Throws UsageError for a name that is none of baseline, avx2, avx512, amx, amx-emulated.
Isa isa_from_name(std::string_view name);

// Whether this processor and its operating system can run `isa`.
bool is_supported(Isa isa);

// The instruction set in use: the widest supported one that is not emulated, unless the environment variable
// PENUMBRA_ISA or a call of use_isa names another.
Isa current_isa();
// For `--isa`: to be called before any network is built. Throws UsageError where this machine cannot run it.
void use_isa(Isa isa);

}  // namespace penumbra::nn
