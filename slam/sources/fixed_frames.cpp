#include "slam/sources/fixed_frames.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>

namespace penumbra::slam {

namespace {

std::string plain(std::string_view frame) {
  return std::string(frame.starts_with('/') ? frame.substr(1) : frame);
}

std::optional<SE3> motion_of(const TransformMessage& transform) {
  constexpr double kTolerance = 1e-3;
  const auto& [x, y, z, w] = transform.rotation;
  const Eigen::Quaterniond rotation(w, x, y, z);
  const Eigen::Vector3d translation(transform.translation.data());
  if (!(std::abs(rotation.norm() - 1.0) < kTolerance) || !translation.allFinite()) return std::nullopt;
  return SE3{rotation.normalized().toRotationMatrix(), translation};
}

}  // namespace

std::optional<SE3> fixed_transform(std::span<const TransformMessage> transforms, std::string_view to,
                                   std::string_view from) {
  std::map<std::string, SE3> to_reached{{plain(to), SE3{}}};  // T_to_frame
  const std::string wanted = plain(from);
  for (bool is_new = true; is_new && !to_reached.contains(wanted);) {
    is_new = false;
    for (const TransformMessage& transform : transforms) {
      const std::string parent = plain(transform.parent), child = plain(transform.child);
      const auto at_parent = to_reached.find(parent), at_child = to_reached.find(child);
      if ((at_parent == to_reached.end()) == (at_child == to_reached.end())) continue;
      const std::optional<SE3> T_parent_child = motion_of(transform);
      if (!T_parent_child) continue;
      is_new = true;
      if (at_child == to_reached.end()) {
        to_reached[child] = at_parent->second * *T_parent_child;
      } else {
        to_reached[parent] = at_child->second * T_parent_child->inverse();
      }
    }
  }
  const auto found = to_reached.find(wanted);
  if (found == to_reached.end()) return std::nullopt;
  return found->second;
}

}  // namespace penumbra::slam
