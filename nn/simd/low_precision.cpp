#include "nn/simd/low_precision.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>

#include "nn/base/error.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

namespace {

// How bf16 is multiplied without a tile unit; `tiles` as long as nobody has asked.
std::atomic<Bf16Arithmetic>& vector_arithmetic() {
  static std::atomic<Bf16Arithmetic> arithmetic = Bf16Arithmetic::tiles;
  return arithmetic;
}

std::once_flag measured;

#if defined(__x86_64__)
// Seconds of some calls of a full tile whose inputs and weights are in the L1 cache.
double tile_seconds(const TileKernels& tile, const std::byte* zeros) {
  constexpr int kCalls = 20, kTaps = 4, kDepth = 32;
  constexpr std::ptrdiff_t taps[kTaps] = {};
  alignas(64) float output[kMaxTilePixels * kTileBlockOutputs];
  constexpr float kBias[kTileBlockOutputs] = {};
  TileArguments a;
  a.input = a.weights = zeros;
  a.input_pixel_stride = 16;
  a.taps = taps;
  a.tap_count = kTaps;
  a.depth = kDepth;
  a.bias = kBias;
  a.output = output;
  a.output_pixel_stride = kTileBlockOutputs;
  a.output_block_stride = kTileBlockOutputs / 2;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kCalls; ++i) tile.full[static_cast<std::size_t>(tile.pixels - 1)](a);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Both in turn; the fastest run of each counts, in which nothing came between. They differ by nothing or by
// half, so that the threshold between is far from both.
Bf16Arithmetic faster_arithmetic() {
  constexpr int kRuns = 12;
  constexpr double kWorthIt = 0.75;  // of the time of f32: inputs must be converted as well
  constexpr std::size_t kZeros = 4 * 32 * kTileBlockOutputs * sizeof(float);
  alignas(64) static constexpr std::byte zeros[kZeros] = {};
  double f32 = std::numeric_limits<double>::infinity(), dot_products = f32;
  for (int run = 0; run < kRuns; ++run) {
    f32 = std::min(f32, tile_seconds(*kernels().tile, zeros));
    dot_products = std::min(dot_products, tile_seconds(avx512_low::kBf16Kernels.tile, zeros));
  }
  return dot_products < kWorthIt * f32 ? Bf16Arithmetic::dot_products : Bf16Arithmetic::f32;
}
#else
Bf16Arithmetic faster_arithmetic() { return Bf16Arithmetic::dot_products; }
#endif

}  // namespace

const char* to_string(Precision precision) {
  switch (precision) {
    case Precision::f32:
      return "f32";
    case Precision::bf16:
      return "bf16";
    case Precision::int8:
      return "int8";
  }
  return "?";
}

Precision precision_from_name(std::string_view name) {
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    if (name == to_string(precision)) return precision;
  }
  throw UsageError(fmt::format("precision: expected f32, bf16 or int8, found '{}'", name));
}

bool is_supported(Precision precision) {
  if (precision == Precision::f32) return true;
  if (tile_unit() != nullptr) return true;
#if defined(__x86_64__)
  // Both kinds of kernels are in one file, which is compiled for both extensions.
  return current_isa() == Isa::avx512 && __builtin_cpu_supports("avx512bf16") != 0 &&
         __builtin_cpu_supports("avx512vnni") != 0;
#else
  return current_isa() == Isa::neon_bf16 || (current_isa() == Isa::neon_dot && precision == Precision::int8);
#endif
}

void require(Precision precision) {
  if (is_supported(precision)) return;
#if defined(__x86_64__)
  constexpr auto kNeeded =
      "a processor with AMX, or with AVX512_BF16 and AVX512_VNNI, and the amx or avx512 instruction set";
#else
  constexpr auto kNeeded =
      "an ARM processor with BF16 and I8MM (for int8 alone: with DotProd) and the neon-bf16 (or neon-dot) "
      "instruction set";
#endif
  throw UsageError(fmt::format("precision {}: needs {}, which is {} here; f32 runs everywhere",
                               to_string(precision), kNeeded, to_string(current_isa())));
}

const char* to_string(Bf16Arithmetic arithmetic) {
  switch (arithmetic) {
    case Bf16Arithmetic::tiles:
      return "tile products";
    case Bf16Arithmetic::dot_products:
      return "dot products";
    case Bf16Arithmetic::f32:
      return "f32 multiply-adds";
  }
  return "?";
}

Bf16Arithmetic bf16_arithmetic() {
  require(Precision::bf16);
  if (tile_unit() != nullptr) return Bf16Arithmetic::tiles;
  std::call_once(measured, [] {
    if (vector_arithmetic() == Bf16Arithmetic::tiles) vector_arithmetic() = faster_arithmetic();
  });
  return vector_arithmetic();
}

void use_bf16_arithmetic(Bf16Arithmetic arithmetic) { vector_arithmetic() = arithmetic; }

const LowPrecisionKernels& low_precision_kernels(Precision precision) {
  static constexpr LowPrecisionKernels kTiles{{kTileRows, kTileBlockOutputs, {}, {}}, nullptr};
  if (tile_unit() != nullptr) return kTiles;
#if defined(__x86_64__)
  return precision == Precision::bf16 ? avx512_low::kBf16Kernels : avx512_low::kInt8Kernels;
#elif defined(__aarch64__)
  if (current_isa() == Isa::neon_dot) return neon_dot::kInt8Kernels;
  return precision == Precision::bf16 ? neon_bf16::kBf16Kernels : neon_bf16::kInt8Kernels;
#else
  throw UsageError(fmt::format("precision {}: no kernels for this processor", to_string(precision)));
#endif
}

}  // namespace penumbra::nn
