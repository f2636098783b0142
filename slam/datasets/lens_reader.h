// One lens of a calibration.yaml, in any of the ways to write it.
#pragma once

#include <initializer_list>
#include <string>

#include "slam/datasets/rectification.h"
#include "slam/datasets/yaml_file.h"

namespace penumbra::slam {

// The keys under `prefix` ("left.", "right.", or ""), under their own names (slam/datasets/camera_keys.h):
//   fx fy cx cy, or intrinsics [fx, fy, cx, cy], or camera_matrix, 3 x 3 row by row;
//   distortion with distortion_model, or k1 k2 p1 p2 [k3], or k1 k2 k3 k4 (equidistant); nothing but zeros is
//   none;
//   width and height, or resolution: here, or without prefix for both lenses; not needed without distortion.
// Throws InputError (file:line) for keys that are missing, two ways at once, or numbers that no camera has.
LensCamera read_lens(const YamlFile& yaml, const std::string& prefix);

// Throws InputError for a camera model, the value of `key` if there is one, that is not pinhole.
void require_pinhole(const YamlFile& yaml, const std::string& key);

// The one of `keys` that the file has; the first where it has none. Throws InputError where it has two.
std::string one_of(const YamlFile& yaml, std::initializer_list<std::string> keys);

}  // namespace penumbra::slam
