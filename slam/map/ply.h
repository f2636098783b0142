// Writes a map as a PLY point cloud, which MeshLab, CloudCompare and Blender open.
#pragma once

#include <filesystem>

#include "slam/map/map.h"

namespace penumbra::slam {

// Binary little-endian PLY: the map points in the colour of the image, then the keyframes' positions in red;
// per vertex x, y, z (float, metres, world) and red, green, blue (uchar). Written under a temporary name and
// then renamed; throws Error where that fails.
void write_ply(const std::filesystem::path& path, const Map& map);

}  // namespace penumbra::slam
