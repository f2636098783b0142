#include "slam/world/frame_geometry.h"

#include <algorithm>
#include <cmath>

#include "nn/base/ceil_div.h"

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

Rect FrameGeometry::pixels_of(int number) const {
  Rect pixels;
  for (const int b : object_bodies_[static_cast<std::size_t>(number)]) {
    pixels = bounding(pixels, bodies_[static_cast<std::size_t>(b)].pixels);
  }
  return pixels;
}

}  // namespace penumbra::slam::synthetic
