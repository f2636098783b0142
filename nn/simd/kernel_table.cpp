#include "nn/simd/kernel_table.h"

namespace penumbra::nn {

const KernelTable& kernels() {
  switch (current_isa()) {
    case Isa::avx512:
      return avx512::kKernels;
    case Isa::avx2:
      return avx2::kKernels;
    case Isa::baseline:
      break;
  }
  return baseline::kKernels;
}

}  // namespace penumbra::nn
