// A map as a PLY point cloud, which MeshLab, CloudCompare and Blender open.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "slam/map/map.h"

namespace penumbra::slam {

// Binary little-endian PLY: the map points in the colour of the image, then the keyframes' positions in red;
// per vertex x, y, z (float, metres, world) and red, green, blue (uchar). Written under a temporary name and
// then renamed; throws Error where that fails.
void write_ply(const std::filesystem::path& path, const Map& map);

struct PlyVertex {
  std::array<float, 3> position;       // metres
  std::array<std::uint8_t, 3> colour;  // red, green, blue
};

// What write_ply writes of a map, whose mutex the caller holds shared where others may change it.
std::vector<PlyVertex> vertices_of(const Map& map);

// The vertices of a file that write_ply wrote. Throws InputError for any other, or a torn one.
std::vector<PlyVertex> read_ply(const std::filesystem::path& path);

}  // namespace penumbra::slam
