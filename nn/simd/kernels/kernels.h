// The kernels of one instruction set, PENUMBRA_ISA, from which table.cpp makes its table.
#pragma once

#include "nn/simd/kernel_table.h"

namespace penumbra::nn::PENUMBRA_ISA {

extern const TileKernels kRegisterTile;
void winograd_input(const WinogradInputArguments& a);
void winograd_output(const WinogradOutputArguments& a);
void activate(float* values, std::ptrdiff_t count, Activation activation, float slope);
void roi_align(const RoiAlignArguments& a);
double peak_loop(long iterations);

}  // namespace penumbra::nn::PENUMBRA_ISA
