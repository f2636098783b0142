// One lens of a calibration.yaml, in any of the ways to write it.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "slam/geometry/rectification.h"
#include "slam/sources/calibration/yaml_file.h"

namespace penumbra::slam {

// The keys under `prefix` ("left.", "right.", or ""), under their own names
// (slam/sources/calibration/camera_keys.h):
//   fx fy cx cy, or intrinsics [fx, fy, cx, cy], or camera_matrix, 3 x 3 row by row;
//   distortion with distortion_model, or k1 k2 p1 p2 [k3], or k1 k2 k3 k4 (equidistant);
//   nothing but zeros is none;
//   width and height, or resolution: here, or without prefix for both lenses; not needed without distortion.
// Throws InputError (file:line) for keys that are missing, two ways at once, or numbers that no camera has.
LensCamera read_lens(const YamlFile& yaml, const std::string& prefix);

// "radial-tangential" ("radtan", "brown_conrady", ROS's "plumb_bob"), "rational" (ROS's
// "rational_polynomial"; 8, 12 or 14 coefficients), "equidistant" ("equi", "fisheye", "kannala_brandt") or
// "none", in any letters (plain_word). Throws InputError naming `place` for another name, or where
// `distortion` has another number of coefficients than the model.
void set_lens_model(LensCamera& camera, std::string_view name, const std::vector<double>& distortion,
                    const std::string& place);
// Which of these three a lens is: radial-tangential and rational differ in the number of coefficients.
const char* lens_model_name(LensModel model, std::size_t coefficients);

// [fx, fy, cx, cy], or the camera matrix fx 0 cx, 0 fy cy, 0 0 1; width and height in pixels. Throw
// InputError naming `place` for numbers that no camera has.
void set_intrinsics(LensCamera& camera, const std::vector<double>& numbers, const std::string& place);
void set_size(LensCamera& camera, double width, double height, const std::string& place);

// Throws InputError for a camera model, the value of `key` if there is one, that is not pinhole.
void require_pinhole(const YamlFile& yaml, const std::string& key);

// The key of a matrix's numbers: `key`, or `key`.data as OpenCV and ROS write matrices.
std::string matrix_key(const YamlFile& yaml, const std::string& key);

// The one of `keys` that the file has; the first where it has none. Throws InputError where it has two.
std::string one_of(const YamlFile& yaml, std::initializer_list<std::string> keys);

}  // namespace penumbra::slam
