// Instruction sets that the vector kernels are compiled for, and the one that this machine gets.
#pragma once

#include <array>
#include <string_view>

namespace penumbra::nn {

enum class Isa {
  // x86-64-v2: SSE4.2, 4 floats a vector. On other processors vectors of 4 floats that the compiler
  // translates.
  baseline,
  // x86-64
  avx2,    // x86-64-v3: AVX2 and FMA, 8 floats
  avx512,  // x86-64-v4: AVX-512 F BW CD DQ VL, 16 floats
  amx,     // avx512, and the tile unit for bf16 and int8 (tile_unit.h)
  // The widest of the first three, and a tile unit in software: slow, for tests on machines without one.
  amx_emulated,
  // aarch64
  neon,       // Armv8-A: 4 floats
  neon_dot,   // neon, and SDOT for int8 (Armv8.2-A DotProd)
  neon_bf16,  // neon, BFMMLA for bf16 and SMMLA for int8 (Armv8.6-A BF16 and I8MM)
};

// Those that this program has, narrowest first, and those of them with vector kernels of their own.
#if defined(__x86_64__)
inline constexpr std::array kIsas{Isa::baseline, Isa::avx2, Isa::avx512, Isa::amx, Isa::amx_emulated};
inline constexpr std::array kKernelIsas{Isa::baseline, Isa::avx2, Isa::avx512};
#elif defined(__aarch64__)
inline constexpr std::array kIsas{Isa::baseline, Isa::neon, Isa::neon_dot, Isa::neon_bf16};
inline constexpr std::array kKernelIsas{Isa::baseline, Isa::neon};
#else
inline constexpr std::array kIsas{Isa::baseline};
inline constexpr std::array kKernelIsas{Isa::baseline};
#endif

const char* to_string(Isa isa);
// Throws UsageError for a name that is none of kIsas.
Isa isa_from_name(std::string_view name);

// Whether this processor and its operating system can run `isa`.
bool is_supported(Isa isa);

// The instruction set in use: the widest supported one that is not emulated, unless the environment variable
// PENUMBRA_ISA or a call of use_isa names another.
Isa current_isa();
// For `--isa`: to be called before any network is built. Throws UsageError where this machine cannot run it.
void use_isa(Isa isa);

}  // namespace penumbra::nn
