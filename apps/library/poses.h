// Poses of the library's headers to those of the SLAM and back.
#pragma once

#include "penumbra/pose.h"
#include "slam/geometry/se3.h"

namespace penumbra {

Pose pose_of(const slam::SE3& T);
// Throws InputError naming `place` where the rotation is none: it would bend what it is applied to unseen.
slam::SE3 motion_of(const Pose& pose, const char* place);

}  // namespace penumbra
