// What the tests of the synthetic street share.
#pragma once

#include <cmath>
#include <cstdint>

#include "slam/world/frame_geometry.h"
#include "slam/world/street_sequence.h"

namespace penumbra::slam::synthetic {

inline SE3 right_of(const SE3& T_wc, double baseline) {
  SE3 right = T_wc;
  right.translation += baseline * T_wc.rotation.col(0);
  return right;
}

// FNV-1a over the bytes of an image's rows.
template <class T>
std::uint64_t hash_image(const Image<T>& image, std::uint64_t hash = 0xcbf29ce484222325U) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(image.data());
  for (std::size_t i = 0; i < image.elements() * sizeof(T); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3U;
  return hash;
}

struct CastResult {
  double depth = 0.0;
  std::int32_t surface = kSky;
};

// What `geometry`'s camera sees in the direction of `point` (its own frame); the point must lie in the image.
inline CastResult cast_towards(const FrameGeometry& geometry, const Eigen::Vector3d& point) {
  const Eigen::Vector2d pixel = geometry.camera().project(point);
  const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
  RayBatch batch;
  batch.x[0] = static_cast<float>(point.x() / point.z());
  batch.y[0] = static_cast<float>(point.y() / point.z());
  geometry.cast((row / kTileHeight) * geometry.tiles_x() + column / kTileWidth, batch, 1);
  return {batch.depth[0], batch.surface[0]};
}

inline bool is_ragged(const FrameGeometry& geometry, std::int32_t surface) {
  if (surface < 0) return false;
  return geometry.world().bodies[static_cast<std::size_t>(geometry.body(surface).body)].ragged;
}

}  // namespace penumbra::slam::synthetic
