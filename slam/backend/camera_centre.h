// Where a camera is: C with T_cw C = 0, in the world.
#pragma once

#include "slam/geometry/se3.h"

namespace penumbra::slam {

inline Eigen::Vector3d camera_centre(const SE3& T_cw) { return T_cw.inverse().translation; }

}  // namespace penumbra::slam
