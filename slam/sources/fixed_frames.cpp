#include "slam/sources/fixed_frames.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

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

struct Neighbour {
  std::string frame;
  SE3 T_neighbour_frame;
};

}  // namespace

std::map<std::string, SE3> fixed_frames(std::span<const TransformMessage> transforms, std::string_view from) {
  std::multimap<std::string, Neighbour> neighbours;  // of each frame: its parent and its children
  for (const TransformMessage& transform : transforms) {
    const std::optional<SE3> T_parent_child = motion_of(transform);
    if (!T_parent_child) continue;
    const std::string parent = plain(transform.parent), child = plain(transform.child);
    neighbours.emplace(child, Neighbour{parent, *T_parent_child});
    neighbours.emplace(parent, Neighbour{child, T_parent_child->inverse()});
  }
  std::map<std::string, SE3> reached{{plain(from), SE3{}}};
  std::vector<std::string> open{plain(from)};
  while (!open.empty()) {
    const std::string frame = std::move(open.back());
    open.pop_back();
    const SE3 T_frame_from = reached.at(frame);
    const auto [begin, end] = neighbours.equal_range(frame);
    for (auto at = begin; at != end; ++at) {
      const Neighbour& next = at->second;
      if (reached.emplace(next.frame, next.T_neighbour_frame * T_frame_from).second)
        open.push_back(next.frame);
    }
  }
  return reached;
}

std::optional<SE3> fixed_transform(std::span<const TransformMessage> transforms, std::string_view to,
                                   std::string_view from) {
  const std::map<std::string, SE3> reached = fixed_frames(transforms, from);
  const auto found = reached.find(plain(to));
  if (found == reached.end()) return std::nullopt;
  return found->second;
}

}  // namespace penumbra::slam
