#include "nn/simd/low_precision.h"

#include "nn/base/error.h"

namespace penumbra::nn {

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
  // Both kinds of kernels are in one file, which is compiled for both extensions.
  return current_isa() == Isa::avx512 && __builtin_cpu_supports("avx512bf16") != 0 &&
         __builtin_cpu_supports("avx512vnni") != 0;
}

void require(Precision precision) {
  if (is_supported(precision)) return;
  throw UsageError(
      fmt::format("precision {}: needs a processor with AVX512_BF16 and AVX512_VNNI and the avx512 "
                  "instruction set, which is {} here; f32 runs everywhere",
                  to_string(precision), to_string(current_isa())));
}

const LowPrecisionKernels& low_precision_kernels(Precision precision) {
  return precision == Precision::bf16 ? avx512_low::kBf16Kernels : avx512_low::kInt8Kernels;
}

int channel_group(Precision precision) {
  switch (precision) {
    case Precision::f32:
      break;
    case Precision::bf16:
      return 2;
    case Precision::int8:
      return 4;
  }
  return 1;
}

int element_size(Precision precision) { return 4 / channel_group(precision); }

}  // namespace penumbra::nn
