// Where things stand on a robot that does not bend: transforms, each from a frame to its parent, put together
// along the way from one frame to another.
//
//   p_parent = R(quaternion) p_child + translation      geometry_msgs/TransformStamped, REP 105
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "slam/geometry/se3.h"
#include "slam/sources/bag/messages.h"

namespace penumbra::slam {

// T_frame_from of every frame that hangs together with `from`, itself included; names have no slash before
// them. Transforms whose numbers are no rotation do not count. Cost: N log N of the transforms.
std::map<std::string, SE3> fixed_frames(std::span<const TransformMessage> transforms, std::string_view from);

// T_to_from; nothing where they do not hang together.
std::optional<SE3> fixed_transform(std::span<const TransformMessage> transforms, std::string_view to,
                                   std::string_view from);

}  // namespace penumbra::slam
