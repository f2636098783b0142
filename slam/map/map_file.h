// The map on disk: everything that is needed to find one's way in it again, or to go on building it.
//
//   "PENUMAP\n"  version u32  CRC-32 of the body u32  bytes of the body u64  | body
//   body: camera (fx fy cx cy baseline, disparity offset f64, width height i32)
//         pyramid: levels u32, scales f64[]
//         keyframes u32, then each: frame i32, timestamp f64, T_cw (rotation f64[9] by rows, translation
//           f64[3]), sub-map i32, features u32 and their arrays: keypoints (u v f32, level i32, angle
//           response f32), descriptors u64[4], u_right f32, depth f32, movable u8, colour u8[3];
//           objects u32, then each: number i32, class name (bytes u32, chars), position f64[3], region
//           (x y width height i32), stands u8
//         points u32, then each: position f64[3], visible found i32, colour u8[3], patch, observations u32,
//           each: keyframe u32 (place in the file), feature u32, aligned u8; ordered by keyframe
//         patch: level i32, and unless it is -1 (no patch): depth f64, offset f32[2], pixels u8[225]
//
// Little-endian, no padding. What can be computed from this is not stored: point descriptors and normals, the
// covisibility graph, the place index. 64 bytes a feature, 300 a point: about 150 kB a keyframe.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"

namespace penumbra::slam {

inline constexpr std::string_view kMapFileMagic = "PENUMAP\n";
inline constexpr std::uint32_t kMapFileVersion = 3;

// Writes under a temporary name and renames: an older file is replaced by a whole new one or not at all.
// Holds the map's mutex shared while it collects what to write. Throws Error where that fails.
void write_map(const std::filesystem::path& path, const Map& map);

// Throws InputError naming `place` where the map was made by another camera than `now`: another image size,
// or a focal length, principal point or baseline that differs by more than a ten-thousandth of the focal
// length or of the baseline.
void require_same_camera(const StereoCamera& of_map, const StereoCamera& now, const std::string& place);

// Reads all or nothing. Throws InputError that names the file and the byte where it is no map, of another
// version, torn, damaged, or where what it says cannot be: counts beyond the file, references to keyframes or
// features that do not exist, numbers that are not finite, rotations that are none, a feature with two
// points. Keyframes are numbered anew from 0, in their old order.
std::unique_ptr<Map> read_map(const std::filesystem::path& path);

}  // namespace penumbra::slam
