// The kernels of one instruction set, PENUMBRA_ISA, from which table.cpp makes its table.
#pragma once

#include "nn/simd/kernel_table.h"

namespace penumbra::nn::PENUMBRA_ISA {

extern const TileKernels kRegisterTile;
void winograd_input(const WinogradInputArguments& a);
void winograd_output(const WinogradOutputArguments& a);
void winograd_weights(const WinogradWeightArguments& a);
void activate(float* values, std::ptrdiff_t count, Activation activation, float slope);
void roi_align(const RoiAlignArguments& a);
int find_overlap(const FindOverlapArguments& a);
void mix_row(const MixRowArguments& a);
void attend(const AttendArguments& a);
double peak_loop(long iterations);
void bit_differences(const std::uint64_t* one, const std::uint64_t* rows, int count,
                     std::uint16_t* differences);

void fast_scores(const std::uint8_t* centre, std::ptrdiff_t pitch, int count, int threshold,
                 std::uint8_t* scores);
void peaks(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int count,
           int least, std::uint8_t* is_peak);
void blur_rows(const std::uint8_t* const* rows, const std::uint8_t* weights, int width, float* out);
void blur_columns(const float* columns, const std::uint8_t* weights, int width, std::uint8_t* out);
void resize_row(const ResizeRowArguments& a);
void resize_mix(const std::int16_t* upper, const std::int16_t* lower, int w0, int w1, int width,
                std::uint8_t* out);
void remap_row(const RemapRowArguments& a);
std::uint64_t slope_energy(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                           int count, int least);
void grey_row(const std::uint8_t* bgr, int count, std::uint8_t* grey);
void flow_window(const std::uint8_t* corner, std::ptrdiff_t pitch, const int* weights, FlowWindow& window);
void flow_mismatch(const std::uint8_t* corner, std::ptrdiff_t pitch, const int* weights,
                   const FlowWindow& window, std::int64_t* sums);
void halve_rows(const std::uint8_t* const* rows, int width, std::uint16_t* out);
void halve_columns(const std::uint16_t* columns, int width, std::uint8_t* out);
void disc_moments(const std::uint8_t* centre, std::ptrdiff_t pitch, const DiscWeights& weights, int* m10,
                  int* m01);
void patch_differences(const std::uint8_t* left, std::ptrdiff_t left_pitch, const std::uint8_t* right,
                       std::ptrdiff_t right_pitch, int* sums);

}  // namespace penumbra::nn::PENUMBRA_ISA
