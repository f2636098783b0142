// A cognitive map on disk: everything that is needed to find one's way in it again.
//
//   "PENUCOG\n"  version u32  CRC-32 of the body u32  bytes of the body u64  | body
//   body: camera (fx fy cx cy baseline, disparity offset f64, width height i32), its yaw and pitch on the
//         robot f64, kind of templates u32,
//         scene's distance f64
//         nodes u32, then each: frame i32, time f64, x y heading strength f64, activity (count u32, f32[]),
//           points (count u32, 48 bytes each: descriptor u64[4], position f32[3], 4 unused), template:
//           landmarks (count u32, 156 bytes each) or profile f32[600]
//         links u32, then each: from to i32, x y heading metres radians f64, recalled u8
//
// Little-endian. About 12 kB a node.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "slam/brain/map/cognitive_map.h"
#include "slam/brain/templates/template_memory.h"

namespace penumbra::slam::brain {

inline constexpr std::string_view kCognitiveMapMagic = "PENUCOG\n";
inline constexpr std::uint32_t kCognitiveMapVersion = 1;

// A map as it lies on disk.
struct StoredMap {
  StereoCamera camera;
  double camera_yaw = 0.0, camera_pitch = 0.0;  // radians, see CameraMount
  TemplateKind templates = TemplateKind::landmarks;
  double scene_distance = 0.0;  // metres, median of what was seen; 0: unknown
  CognitiveMap map;
  std::vector<Template> views;  // per node
};

// Writes under a temporary name and renames: an older file is replaced by a whole new one or not at all.
// Throws Error where that fails.
void write_cognitive_map(const std::filesystem::path& path, const StoredMap& stored);

// Reads all or nothing. Throws InputError that names the file and the byte where it is no cognitive map, of
// another version, torn, damaged, or where what it says cannot be: counts beyond the file, links to nodes
// that do not exist, numbers that are not finite.
StoredMap read_cognitive_map(const std::filesystem::path& path);

}  // namespace penumbra::slam::brain
