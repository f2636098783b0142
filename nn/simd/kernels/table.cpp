#include "nn/simd/kernels/kernels.h"

namespace penumbra::nn::PENUMBRA_ISA {

extern const KernelTable kKernels;
const KernelTable kKernels = {&kRegisterTile, winograd_input, winograd_output,
                              activate,       roi_align,      peak_loop};

}  // namespace penumbra::nn::PENUMBRA_ISA
