#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

const KernelTable& kernels() {
  switch (current_isa()) {
    case Isa::amx:
    case Isa::avx512:
      return avx512::kKernels;
    case Isa::avx2:
      return avx2::kKernels;
    case Isa::amx_emulated:
      return is_supported(Isa::avx512) ? avx512::kKernels : avx2::kKernels;
    case Isa::baseline:
      break;
  }
  return baseline::kKernels;
}

}  // namespace penumbra::nn
