#include "slam/world/frame_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "nn/base/ceil_div.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

std::array<Eigen::Vector3f, 8> corners_of(const Eigen::Vector3f& lower, const Eigen::Vector3f& upper) {
  std::array<Eigen::Vector3f, 8> corners;
  for (int i = 0; i < 8; ++i) {
    corners[static_cast<std::size_t>(i)] = {(i & 1) != 0 ? upper.x() : lower.x(),
                                            (i & 2) != 0 ? upper.y() : lower.y(),
                                            (i & 4) != 0 ? upper.z() : lower.z()};
  }
  return corners;
}

}  // namespace

void FrameGeometry::prepare(const World& world, const StereoCamera& camera, const SE3& T_wc, double time) {
  world_ = &world;
  camera_ = camera;
  world_from_camera_ = T_wc.rotation.cast<float>();
  camera_position_ = T_wc.translation;
  down_ = world_from_camera_.transpose() * Eigen::Vector3f::UnitY();
  height_ = static_cast<float>(-T_wc.translation.y());
  objects_.clear();
  bodies_.clear();
  for (std::size_t i = 0; i < world.objects.size(); ++i) place(static_cast<int>(i), time);
  // Front to back, so that a tile can stop at the first body behind all it has; ties keep the world's order.
  std::stable_sort(bodies_.begin(), bodies_.end(),
                   [](const FrameBody& a, const FrameBody& b) { return a.nearest < b.nearest; });

  if (object_bodies_.size() < objects_.size()) object_bodies_.resize(objects_.size());
  for (auto& list : object_bodies_) list.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    object_bodies_[static_cast<std::size_t>(bodies_[i].frame_object)].push_back(static_cast<int>(i));
  }

  tiles_x_ = ceil_div(camera.width, kTileWidth);
  tiles_y_ = ceil_div(camera.height, kTileHeight);
  tile_bodies_.resize(static_cast<std::size_t>(tiles()));
  tile_shadows_.resize(static_cast<std::size_t>(tiles()));
  for (auto& list : tile_bodies_) list.clear();
  for (auto& list : tile_shadows_) list.clear();
  const auto bin = [&](const Rect& pixels, int number, std::vector<std::vector<int>>& lists) {
    if (pixels.empty()) return;
    for (int ty = pixels.y / kTileHeight; ty <= (pixels.y + pixels.height - 1) / kTileHeight; ++ty) {
      for (int tx = pixels.x / kTileWidth; tx <= (pixels.x + pixels.width - 1) / kTileWidth; ++tx) {
        lists[static_cast<std::size_t>(ty * tiles_x_ + tx)].push_back(number);
      }
    }
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) bin(bodies_[i].pixels, static_cast<int>(i), tile_bodies_);
  for (std::size_t i = 0; i < objects_.size(); ++i)
    bin(objects_[i].shadow, static_cast<int>(i), tile_shadows_);
}

Rect FrameGeometry::tile_pixels(int tile) const {
  const Rect pixels{(tile % tiles_x_) * kTileWidth, (tile / tiles_x_) * kTileHeight, kTileWidth, kTileHeight};
  return intersection(pixels, {0, 0, camera_.width, camera_.height});
}

// Pixels that the convex hull of `corners` (camera frame) may touch, with a border for sub-pixel samples.
Rect FrameGeometry::project_hull(const Eigen::Vector3f* corners, int count) const {
  float left = 1e9F, right = -1e9F, top = 1e9F, bottom = -1e9F;
  const auto add = [&](const Eigen::Vector3f& p) {
    const float u = static_cast<float>(camera_.fx) * p.x() / p.z() + static_cast<float>(camera_.cx);
    const float v = static_cast<float>(camera_.fy) * p.y() / p.z() + static_cast<float>(camera_.cy);
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
  };
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f& p = corners[i];
    if (p.z() >= kNearDepth) {
      add(p);
      continue;
    }
    // Behind the near plane: where the lines to the corners in front of it pass through it.
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector3f& q = corners[k];
      if (q.z() >= kNearDepth) add(p + (q - p) * ((kNearDepth - p.z()) / (q.z() - p.z())));
    }
  }
  if (right < -1.0F || bottom < -1.0F || left > static_cast<float>(camera_.width) ||
      top > static_cast<float>(camera_.height) || left > right) {
    return {};
  }
  const int x0 = std::max(0, static_cast<int>(std::floor(std::max(left, -10.0F))) - 1);
  const int y0 = std::max(0, static_cast<int>(std::floor(std::max(top, -10.0F))) - 1);
  const int x1 = static_cast<int>(std::ceil(std::min(right, static_cast<float>(camera_.width - 2)))) + 1;
  const int y1 = static_cast<int>(std::ceil(std::min(bottom, static_cast<float>(camera_.height - 2)))) + 1;
  return intersection({x0, y0, x1 + 1 - x0, y1 + 1 - y0}, {0, 0, camera_.width, camera_.height});
}

void FrameGeometry::place(int object_number, double time) {
  const Object& object = world_->objects[static_cast<std::size_t>(object_number)];
  const SE3 T_wo = placement_at(*world_, object, time);
  const Eigen::Vector2d to_object(T_wo.translation.x() - camera_position_.x(),
                                  T_wo.translation.z() - camera_position_.z());
  const double size = (object.upper - object.lower).cast<double>().norm();
  if (to_object.norm() - size > kFarDistance) return;
  // Behind the camera by more than its size and its longest shadow: neither can be in view.
  const Eigen::Vector3d forward = world_from_camera_.col(2).cast<double>();
  if (to_object.x() * forward.x() + to_object.y() * forward.z() < -2.5 * size - 2.0) return;

  const Eigen::Matrix3d& world_from_local = T_wo.rotation;
  const Eigen::Matrix3f R = (world_from_camera_.cast<double>().transpose() * world_from_local).cast<float>();
  const Eigen::Vector3d camera_in_local =
      world_from_local.transpose() * (camera_position_ - T_wo.translation);

  FrameObject placed;
  placed.object = object_number;
  placed.local_from_camera = R.transpose();
  placed.camera_in_local = camera_in_local.cast<float>();
  placed.sun_in_local = world_from_local.transpose().cast<float>() * world_->to_sun;
  const auto to_camera = [&](const Eigen::Vector3f& p) -> Eigen::Vector3f {
    return R * (p - placed.camera_in_local);
  };
  bool casts_shadow = false, seen = false;
  for (int b = object.first_body; b < object.first_body + object.body_count; ++b) {
    const Body& body = world_->bodies[static_cast<std::size_t>(b)];
    casts_shadow = casts_shadow || body.casts_shadow;
    std::array<Eigen::Vector3f, 8> corners = corners_of(body.lower, body.upper);
    FrameBody in_frame;
    in_frame.nearest = 1e9F;
    for (Eigen::Vector3f& corner : corners) {
      corner = to_camera(corner);
      in_frame.nearest = std::min(in_frame.nearest, corner.z());
    }
    in_frame.pixels = project_hull(corners.data(), 8);
    if (in_frame.pixels.empty()) continue;
    seen = true;
    in_frame.body = b;
    in_frame.frame_object = static_cast<int>(objects_.size());
    for (int i = 0; i < body.plane_count; ++i) {
      const Plane& plane = body.planes[static_cast<std::size_t>(i)];
      in_frame.normal[static_cast<std::size_t>(i)] = R * plane.normal;
      in_frame.value[static_cast<std::size_t>(i)] = static_cast<float>(
          plane.normal.cast<double>().dot(camera_in_local) + static_cast<double>(plane.offset));
    }
    if (body.round) {
      in_frame.scaled_direction = body.inverse_radii.asDiagonal() * placed.local_from_camera;
      in_frame.scaled_origin =
          (body.inverse_radii.cast<double>().cwiseProduct(camera_in_local - body.centre.cast<double>()))
              .cast<float>();
    }
    bodies_.push_back(in_frame);
  }
  if (casts_shadow && world_->ground) {
    // The shadow of the object's box lies in the hull of its corners moved along the sun's rays to the
    // ground.
    std::array<Eigen::Vector3f, 8> corners = corners_of(object.lower, object.upper);
    constexpr float kContact = 0.6F;  // metres around the object that it darkens a little
    for (Eigen::Vector3f& corner : corners) {
      corner.x() += corner.x() > 0.0F ? kContact : -kContact;
      corner.z() += corner.z() > 0.0F ? kContact : -kContact;
      corner -= placed.sun_in_local * (corner.y() / placed.sun_in_local.y());
      corner = to_camera(corner);
    }
    placed.shadow = project_hull(corners.data(), 8);
  }
  if (seen || !placed.shadow.empty()) objects_.push_back(placed);
}

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

Rect FrameGeometry::pixels_of(int number) const {
  Rect pixels;
  for (const int b : object_bodies_[static_cast<std::size_t>(number)]) {
    pixels = bounding(pixels, bodies_[static_cast<std::size_t>(b)].pixels);
  }
  return pixels;
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
