// Where rays meet the bodies of a frame.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "slam/world/frame_geometry.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

void FrameGeometry::cast(int tile, RayBatch& batch, int count) const {
  for (int i = 0; i < count; ++i) {
    // The ground: depth t with height_ = t (down . direction).
    const float slope = down_.x() * batch.x[i] + down_.y() * batch.y[i] + down_.z();
    const bool ground = world_->ground && slope > 1e-5F;
    batch.depth[i] = ground ? height_ / slope : 1e9F;
    batch.surface[i] = ground ? kGround : kSky;
  }
  for (const int number : tile_bodies_[static_cast<std::size_t>(tile)]) {
    const FrameBody& body = bodies_[static_cast<std::size_t>(number)];
    float farthest = batch.depth[0];
    for (int i = 1; i < count; ++i) farthest = std::max(farthest, batch.depth[i]);
    if (body.nearest >= farthest) break;  // so are all that follow
    cast_within(body, number, batch, count);
  }
}

void FrameGeometry::cast_within(const FrameBody& body, std::int32_t number, RayBatch& batch,
                                int count) const {
  // Rays of one batch lie within one row: none of them may meet a body of other rows.
  const float row = batch.y[0] * static_cast<float>(camera_.fy) + static_cast<float>(camera_.cy);
  if (row < static_cast<float>(body.pixels.y) - 1.0F ||
      row > static_cast<float>(body.pixels.y + body.pixels.height)) {
    return;
  }
  // They run from left to right: only those within the body's columns.
  const float inverse_fx = 1.0F / static_cast<float>(camera_.fx), cx = static_cast<float>(camera_.cx);
  const float left = (static_cast<float>(body.pixels.x) - 0.5F - cx) * inverse_fx;
  const float right = (static_cast<float>(body.pixels.x + body.pixels.width) - 0.5F - cx) * inverse_fx;
  int begin = 0, end = count;
  while (begin < end && batch.x[begin] < left) ++begin;
  while (end > begin && batch.x[end - 1] > right) --end;
  if (begin < end) cast_body(body, number, batch, begin, end);
}

void FrameGeometry::cast_alone(std::span<const int> numbers, RayBatch& batch, int count) const {
  for (int i = 0; i < count; ++i) {
    batch.depth[i] = 1e9F;
    batch.surface[i] = kSky;
  }
  for (const int number : numbers) {
    for (const int b : object_bodies_[static_cast<std::size_t>(number)]) {
      cast_within(bodies_[static_cast<std::size_t>(b)], b, batch, count);
    }
  }
}

void FrameGeometry::cast_body(const FrameBody& in_frame, std::int32_t number, RayBatch& batch, int begin,
                              int end) const {
  const Body& body = world_->bodies[static_cast<std::size_t>(in_frame.body)];
  alignas(32) float enter[kTileWidth], leave[kTileWidth];
  alignas(32) std::int32_t face[kTileWidth];
  for (int i = begin; i < end; ++i) {
    enter[i] = kNearDepth;
    leave[i] = 1e9F;
    face[i] = -1;
  }
  if (body.round) {
    const Eigen::Matrix3f& M = in_frame.scaled_direction;
    const Eigen::Vector3f f = in_frame.scaled_origin;
    const float k = f.squaredNorm() - 1.0F;
    for (int i = begin; i < end; ++i) {
      const float ex = M(0, 0) * batch.x[i] + M(0, 1) * batch.y[i] + M(0, 2);
      const float ey = M(1, 0) * batch.x[i] + M(1, 1) * batch.y[i] + M(1, 2);
      const float ez = M(2, 0) * batch.x[i] + M(2, 1) * batch.y[i] + M(2, 2);
      const float a = ex * ex + ey * ey + ez * ez;
      const float b = ex * f.x() + ey * f.y() + ez * f.z();
      const float discriminant = b * b - a * k;
      const float root = std::sqrt(std::max(discriminant, 0.0F));
      const bool met = discriminant > 0.0F;
      const float in = (-b - root) / a;
      leave[i] = met ? (-b + root) / a : -1.0F;
      face[i] = in > enter[i] ? kRoundFace : -1;
      enter[i] = std::max(in, enter[i]);
    }
  }
  for (int p = 0; p < body.plane_count; ++p) {
    const Eigen::Vector3f n = in_frame.normal[static_cast<std::size_t>(p)];
    const float value = in_frame.value[static_cast<std::size_t>(p)];
    for (int i = begin; i < end; ++i) {
      const float slope = n.x() * batch.x[i] + n.y() * batch.y[i] + n.z();
      const float t = -value / slope;
      const float in = slope < 0.0F ? t : -1e9F;
      const float out = slope < 0.0F ? 1e9F : t;
      face[i] = in > enter[i] ? p : face[i];
      enter[i] = in > enter[i] ? in : enter[i];
      leave[i] = out < leave[i] ? out : leave[i];
    }
  }
  if (body.ragged) {
    alignas(32) float depth_before[kTileWidth];
    alignas(32) std::int32_t surface_before[kTileWidth];
    std::memcpy(depth_before, batch.depth, sizeof(depth_before));
    std::memcpy(surface_before, batch.surface, sizeof(surface_before));
    for (int i = begin; i < end; ++i) {
      const bool hit = face[i] >= 0 && enter[i] < leave[i] && enter[i] < batch.depth[i];
      batch.depth[i] = hit ? enter[i] : batch.depth[i];
      batch.surface[i] = hit ? (number << 4) + face[i] : batch.surface[i];
    }
    punch_holes(in_frame, batch, depth_before, surface_before, number, begin, end);
    return;
  }
  for (int i = begin; i < end; ++i) {
    const bool hit = (face[i] >= 0) & (enter[i] < leave[i]) & (enter[i] < batch.depth[i]);
    batch.depth[i] = hit ? enter[i] : batch.depth[i];
    batch.surface[i] = hit ? (number << 4) + face[i] : batch.surface[i];
  }
}

// Foliage: where the noise on the crown's surface is high the ray goes through, the more so near the
// silhouette, where a smooth outline would give the ellipsoid away.
void FrameGeometry::punch_holes(const FrameBody& in_frame, RayBatch& batch, const float* depth_before,
                                const std::int32_t* surface_before, std::int32_t number, int begin,
                                int end) const {
  const Body& body = world_->bodies[static_cast<std::size_t>(in_frame.body)];
  const FrameObject& placed = object(in_frame);
  const std::uint32_t seed = world_->materials[static_cast<std::size_t>(body.material)].seed;
  for (int i = begin; i < end; ++i) {
    if (batch.surface[i] >> 4 != number) continue;
    const Eigen::Vector3f direction =
        placed.local_from_camera * Eigen::Vector3f(batch.x[i], batch.y[i], 1.0F);
    const Eigen::Vector3f p = placed.camera_in_local + batch.depth[i] * direction;
    const Eigen::Vector3f normal = body.inverse_radii.cwiseAbs2().cwiseProduct(p - body.centre).normalized();
    const float facing = -normal.dot(direction) / direction.norm();
    const float noise = 0.5F * value_noise(p.x() * 3.1F, p.y() * 3.1F, p.z() * 3.1F, seed) +
                        0.8F * value_noise(p.x() * 9.0F, p.y() * 9.0F, p.z() * 9.0F, seed + 1U);
    if (noise > 0.9F * facing - 0.12F) {
      batch.depth[i] = depth_before[i];
      batch.surface[i] = surface_before[i];
    }
  }
}

}  // namespace penumbra::slam::synthetic
