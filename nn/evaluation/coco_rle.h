// COCO's run-length encoding of masks, and detections as COCO result entries.
//
// A mask is read column by column; the runs alternate between zeros and ones, starting with zeros (the first
// may be 0 long). As text every run (from the fourth on, its difference to the run two before) is written in
// groups of five bits, lowest first, with bit 5 set while more follow, as the character 48 + group; the last
// group's bit 4 is the sign. Source: the COCO API's maskApi.c, format documented at its rleToString.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nn/layers/mask_paste.h"

namespace penumbra::nn {

// Run lengths of the mask on an image of width x height pixels; they add up to width * height.
std::vector<std::uint32_t> mask_runs(const Mask& mask, int width, int height);

std::string encode_runs(const std::vector<std::uint32_t>& runs);

// Inverse of encode_runs. Throws InputError where the text is no such encoding, its runs pass `pixels` in
// all, or one is of 2^32 pixels or more.
std::vector<std::uint32_t> decode_runs(std::string_view text, std::uint64_t pixels);

}  // namespace penumbra::nn
