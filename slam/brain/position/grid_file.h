// A grid code as a safetensors file (docs/formats.md has the layout of those).
//
//   output               f64 [2]: threshold of the cells, and 1 where their output is bipolar, else 0
//   directions           f64 [n, 2]: of the head-direction ring
//   modules.M.wavelength f64 [1], metres
//   modules.M.start      f64 [n], radians
//   modules.M.weights    f32 [cells, 2 n]
//   metadata             "format": "penumbra grid code 1", and how the code was made
//
// 30 kB for ten modules of 25 cells.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "slam/brain/position/grid_code.h"

namespace penumbra::slam::brain {

// What the file says of how it was made, by name: the room, the seed, what was measured.
using GridCodeHistory = std::map<std::string, std::string>;

// Replaces an older file whole or not at all. Throws Error where that fails.
void write_grid_code(const std::filesystem::path& path, const GridCode& code, const GridCodeHistory& history);

struct StoredGridCode {
  GridCode code;
  GridCodeHistory history;
};

// Throws InputError, which names the file and the tensor, where it is torn, no grid code, or where what it
// says cannot be: shapes that do not fit, numbers that are not finite, directions that are not of length 1.
StoredGridCode read_grid_code(const std::filesystem::path& path);

}  // namespace penumbra::slam::brain
