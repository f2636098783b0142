// Where a camera stands on what carries it, and the poses of that body.
//
//   T_start_body(t) = T_body_camera T_world_camera(t) T_body_camera^-1
//
// The map's world is the left camera's frame where the map began; `start` is the body's frame there, so that
// a body whose z points up, as ROS has it (REP 103), moves in a world whose z points up.
#pragma once

#include <string>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

struct Mounting {
  std::string frame;   // of the body: "base_link", "imu"
  SE3 T_frame_camera;  // of the left rectified camera
};

SE3 pose_of_body(const Mounting& body, const SE3& T_wc);
Trajectory poses_of_body(const Mounting& body, Trajectory poses_of_camera);

// The one of this name; a slash before it does not matter. Throws InputError naming `place` and the frames
// that there are.
const Mounting& mounting_of(const std::string& frame, const std::vector<Mounting>& mountings,
                            const std::string& place);

}  // namespace penumbra::slam
