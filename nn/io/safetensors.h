// safetensors files: named tensors and a table of strings, with nothing in them that could be executed.
//
//   bytes 0..7      N, the length of the header: little-endian, at most 100,000,000
//   bytes 8..8+N    JSON: {"NAME": {"dtype": "F32", "shape": [2, 3], "data_offsets": [BEGIN, END]}, ...,
//                          "__metadata__": {"KEY": "VALUE", ...}}
//   the rest        the tensors, row-major, little-endian; the offsets count from here, leave no gap, do not
//                   overlap and end with the file
//
// Source: the format's description and limits, https://github.com/huggingface/safetensors
#pragma once

#include <cstddef>
#include <filesystem>

#include "nn/io/state_dict.h"

namespace penumbra::nn {

// The longest header that is read, as in the reference implementation.
inline constexpr std::size_t kLongestSafetensorsHeader = 100'000'000;

// Maps the file and checks its header; the tensors stay in the map, so the cost does not depend on their
// size. Throws InputError for a missing, truncated or inconsistent file, naming the tensor or byte that is
// wrong.
StateDict read_safetensors(const std::filesystem::path& path);

// Writes all tensors and the metadata. The file is written under a temporary name in the same folder and then
// renamed, so `path` never holds half a file. Larger element types come first and the header is padded to a
// multiple of 8 bytes, so every tensor is aligned to its element size in a memory map; equal contents give
// equal files. Throws Error where the file cannot be written, InputError where a name or metadata string is
// not UTF-8, a tensor is named "__metadata__", or a tensor's bytes do not fit its shape.
void write_safetensors(const std::filesystem::path& path, const StateDict& state);

}  // namespace penumbra::nn
