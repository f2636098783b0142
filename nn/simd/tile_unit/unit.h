// The functions of one tile unit, from which table.cpp makes its table.
#pragma once

#include "nn/simd/tile_unit.h"

namespace penumbra::nn::PENUMBRA_ISA {

void multiply(const TileUnitArguments& a);
void convert_lines(const ConvertLinesArguments& a);
void split_pixels(const SplitPixelsArguments& a);
void add_lines(const AddLinesArguments& a);
void max_line(const MaxLineArguments& a);
void roi_align_lines(const RoiAlignLinesArguments& a);
void dot_lines(const DotLinesArguments& a);
void tile_product(const TileProductArguments& a);
double peak_loop(Precision precision, long iterations);

}  // namespace penumbra::nn::PENUMBRA_ISA
