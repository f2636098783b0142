// Views of a made room with or without a pillar in it, for tests of the dense map.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/map/dense/fusion.h"

namespace penumbra::test {

inline const slam::StereoCamera kRoomCamera = {
    .fx = 160.0, .fy = 160.0, .cx = 79.5, .cy = 59.5, .baseline = 0.08, .width = 160, .height = 120};
inline constexpr double kAboveFloor = 0.7;  // of the camera above the floor, metres

// The depth of a room: floor 0.7 m below the camera, a wall 3 m ahead; `pillar`: something 1.5 m ahead in the
// middle.
inline FloatImage room(const slam::SE3& T_wc, bool pillar) {
  FloatImage depth(kRoomCamera.width, kRoomCamera.height);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const Eigen::Vector3d ray = T_wc.rotation * kRoomCamera.back_project(u, v, 1.0);
      double z = (3.0 - T_wc.translation.z()) / ray.z();
      if (ray.y() > 0.0) z = std::min(z, (kAboveFloor - T_wc.translation.y()) / ray.y());
      const double to_pillar = (1.5 - T_wc.translation.z()) / ray.z();
      if (pillar && std::abs(T_wc.translation.x() + to_pillar * ray.x()) < 0.2) z = std::min(z, to_pillar);
      depth.at(u, v) = static_cast<float>(z);
    }
  }
  return depth;
}

struct RoomViews {
  std::vector<slam::DenseView> kept;
  std::vector<slam::SE3> poses;

  void add(const slam::SE3& T_wc, bool pillar) {
    const ByteImage image = ByteImage::filled(kRoomCamera.width, kRoomCamera.height, 90);
    kept.push_back(slam::make_dense_view(kRoomCamera, image, room(T_wc, pillar), 1));
    poses.push_back(T_wc);
  }
  std::vector<slam::PosedView> posed() const {
    std::vector<slam::PosedView> views;
    for (std::size_t i = 0; i < kept.size(); ++i) views.push_back({&kept[i], poses[i]});
    return views;
  }
};

inline slam::SE3 at(double x, double z = 0.0) {
  slam::SE3 T;
  T.translation = {x, 0.0, z};
  return T;
}

// How far a voxel is from floor and wall, metres.
inline double off_surface(const slam::Voxel& voxel) {
  return std::min(std::abs(voxel.place.y() - kAboveFloor), std::abs(voxel.place.z() - 3.0));
}

}  // namespace penumbra::test
