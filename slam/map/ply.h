// A map as a PLY point cloud, which MeshLab, CloudCompare and Blender open, and as PCD.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "slam/map/map.h"

namespace penumbra::slam {

struct PlyVertex {
  std::array<float, 3> position;       // metres
  std::array<std::uint8_t, 3> colour;  // red, green, blue
};

// What a map looks like: its points, then the keyframes' positions in red. Points whose place is mostly
// uncertainty (slam/map/point_uncertainty.h) are left out.
struct PointCloud {
  std::vector<PlyVertex> vertices;
  int keyframes = 0;  // the last of the vertices
  int left_out = 0;   // points
};
// Holds the map's mutex shared.
PointCloud point_cloud_of(const Map& map);

// Binary little-endian PLY: per vertex x, y, z (float, metres, world) and red, green, blue (uchar). Written
// under a temporary name and then renamed; throws Error where that fails.
void write_ply(const std::filesystem::path& path, const PointCloud& cloud);

// The same vertices as a PCD file for the Point Cloud Library: v0.7, binary; x y z (F4), rgb (0x00RRGGBB,
// declared F4 as that library does, for pyntcloud misreads U4). Throws Error where it cannot be written.
void write_pcd(const std::filesystem::path& path, const std::vector<PlyVertex>& vertices);

// The vertices of a file that write_ply wrote. Throws InputError for any other, or a torn one.
std::vector<PlyVertex> read_ply(const std::filesystem::path& path);

}  // namespace penumbra::slam
