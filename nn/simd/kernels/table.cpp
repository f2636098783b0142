#include "nn/simd/kernels/kernels.h"

namespace penumbra::nn::PENUMBRA_ISA {

extern const KernelTable kKernels;
const KernelTable kKernels = {
    &kRegisterTile,
    winograd_input,
    winograd_output,
    winograd_weights,
    activate,
    roi_align,
    find_overlap,
    mix_row,
    attend,
    peak_loop,
    bit_differences,
    {fast_scores, peaks, blur_rows, blur_columns, resize_row, resize_mix, remap_row, slope_energy, grey_row,
     flow_window, flow_mismatch, halve_rows, halve_columns, disc_moments, patch_differences}};

}  // namespace penumbra::nn::PENUMBRA_ISA
