// Tells from a camera and the size of its images what is probably wrong with the calibration: values of
// images of another size, in another order or in millimetres.
//
//   principal point outside the middle half of the image
//   horizontal field of view below 15 or above 150 degrees
//   fx and fy more than a tenth apart, unless a lens was undone, which may stretch the image
#pragma once

#include <string>
#include <vector>

#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// A sentence for each; none for a camera that can be. `camera` has width and height.
std::vector<std::string> check_camera(const StereoCamera& camera, bool is_undone = false);

}  // namespace penumbra::slam
