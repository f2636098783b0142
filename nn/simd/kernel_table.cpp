#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

const KernelTable& kernels() {
  switch (current_isa()) {
#if defined(__x86_64__)
    case Isa::amx:
    case Isa::avx512:
      return avx512::kKernels;
    case Isa::avx2:
      return avx2::kKernels;
    case Isa::amx_emulated:
      return is_supported(Isa::avx512) ? avx512::kKernels : avx2::kKernels;
#elif defined(__aarch64__)
    case Isa::neon:
    case Isa::neon_dot:
    case Isa::neon_bf16:
      return neon::kKernels;
#endif
    default:
      return baseline::kKernels;
  }
}

}  // namespace penumbra::nn
