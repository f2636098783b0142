// The dense map as files that others open: PLY (MeshLab, CloudCompare, Blender) and PCD (the Point Cloud
// Library).
//
//   PLY   binary, little endian: x y z (float), red green blue (uchar), class (uchar); "comment class N NAME"
//   a class PCD   v0.7, binary: x y z (F4), rgb (U4: 0x00RRGGBB), label (U4)
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "slam/map/dense/voxel_grid.h"

namespace penumbra::slam {

// `classes`: names by number, number 0 being what has none. Each function throws Error where the file cannot
// be written.
void write_dense_ply(const std::filesystem::path& path, const VoxelGrid& grid,
                     const std::vector<std::string>& classes);
void write_pcd(const std::filesystem::path& path, const VoxelGrid& grid);

// What such a PLY file holds.
struct DenseCloud {
  std::vector<std::array<float, 3>> places;          // metres
  std::vector<std::array<std::uint8_t, 3>> colours;  // red, green, blue
  std::vector<std::uint8_t> labels;                  // numbers of classes
  std::vector<std::string> classes;                  // by number; 0: none
};
// Throws InputError for any other file, or a torn one.
DenseCloud read_dense_ply(const std::filesystem::path& path);

}  // namespace penumbra::slam
