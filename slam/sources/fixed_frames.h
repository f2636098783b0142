// Where things stand on a robot that does not bend: the transforms of /tf_static, each from a frame to its
// parent, put together along the way from one frame to another.
//
//   p_parent = R(quaternion) p_child + translation      geometry_msgs/TransformStamped, REP 105
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "slam/geometry/se3.h"
#include "slam/sources/bag/messages.h"

namespace penumbra::slam {

// T_to_from; nothing where they do not hang together, or numbers on the way are no rotation. Leading slashes
// of names do not matter. Cost: transforms times steps on the way.
std::optional<SE3> fixed_transform(std::span<const TransformMessage> transforms, std::string_view to,
                                   std::string_view from);

}  // namespace penumbra::slam
