// The world as one camera sees it at one time: every visible body in camera coordinates, binned into tiles of
// the image. Rays have direction (x, y, 1), so that a ray parameter is the planar depth Z.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "nn/image/image.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

constexpr int kTileWidth = 32, kTileHeight = 16;  // pixels
constexpr float kNearDepth = 0.1F;                // metres: nothing nearer is seen
constexpr float kFarDistance = 260.0F;            // metres: nothing but ground and sky beyond

// An object placed for one frame: p_local = local_from_camera p_camera + camera_in_local.
struct FrameObject {
  int object = 0;
  Eigen::Matrix3f local_from_camera;
  Eigen::Vector3f camera_in_local;
  Eigen::Vector3f sun_in_local;
  Rect shadow;  // pixels that may show its shadow on the ground; empty where it casts none
};

struct FrameBody {
  int body = 0, frame_object = 0;
  float nearest = 0.0F;  // lower bound of its depth, metres
  Rect pixels;           // where it may be seen
  // Half-space i: value[i] + normal[i] . (x, y, 1) t <= 0.
  std::array<Eigen::Vector3f, Body::kMaxPlanes> normal;
  std::array<float, Body::kMaxPlanes> value;
  // Quadric: |scaled_direction (x, y, 1) t + scaled_origin| <= 1.
  Eigen::Matrix3f scaled_direction;
  Eigen::Vector3f scaled_origin;
};

// Up to kTileWidth rays and the nearest surface found on each so far.
struct RayBatch {
  alignas(32) float x[kTileWidth], y[kTileWidth];
  alignas(32) float depth[kTileWidth];
  alignas(32) std::int32_t surface[kTileWidth];
};

// What a ray met: kSky, kGround, or (FrameBody number << 4) + face; face = plane number, 15 = the quadric.
constexpr std::int32_t kSky = -2, kGround = -1, kRoundFace = 15;

class FrameGeometry {
 public:
  // Places everything that `camera` at T_wc can see at `time`. Buffers are reused from frame to frame.
  void prepare(const World& world, const StereoCamera& camera, const SE3& T_wc, double time);

  // Sets depth and surface of the first `count` rays of `batch` (x and y given), all within the tile.
  void cast(int tile, RayBatch& batch, int count) const;

  // The same with nothing in the world but frame objects `numbers`: surface is kSky where a ray misses them.
  // The rays lie within one row and run from left to right.
  void cast_alone(std::span<const int> numbers, RayBatch& batch, int count) const;
  // Pixels outside of which cast_alone does not find `number`.
  Rect pixels_of(int number) const;

  int tiles_x() const { return tiles_x_; }
  int tiles() const { return tiles_x_ * tiles_y_; }
  Rect tile_pixels(int tile) const;
  const World& world() const { return *world_; }
  const FrameBody& body(std::int32_t surface) const {
    return bodies_[static_cast<std::size_t>(surface >> 4)];
  }
  const FrameObject& object(const FrameBody& body) const {
    return objects_[static_cast<std::size_t>(body.frame_object)];
  }
  // Numbers of the frame objects whose shadows may fall on the ground in the tile.
  const std::vector<int>& shadows(int tile) const { return tile_shadows_[static_cast<std::size_t>(tile)]; }
  const FrameObject& frame_object(int number) const { return objects_[static_cast<std::size_t>(number)]; }
  int frame_objects() const { return static_cast<int>(objects_.size()); }
  const Eigen::Matrix3f& world_from_camera() const { return world_from_camera_; }
  const Eigen::Vector3d& camera_position() const { return camera_position_; }
  const StereoCamera& camera() const { return camera_; }

 private:
  void place(int object, double time);
  // Casts the rays of `batch` that lie within the body's rectangle.
  void cast_within(const FrameBody& body, std::int32_t number, RayBatch& batch, int count) const;
  void cast_body(const FrameBody& body, std::int32_t number, RayBatch& batch, int begin, int end) const;
  void punch_holes(const FrameBody& body, RayBatch& batch, const float* before,
                   const std::int32_t* surface_before, std::int32_t number, int begin, int end) const;
  Rect project_hull(const Eigen::Vector3f* corners, int count) const;

  const World* world_ = nullptr;
  StereoCamera camera_;
  Eigen::Matrix3f world_from_camera_;
  Eigen::Vector3d camera_position_;
  Eigen::Vector3f down_;  // the ground's normal in camera coordinates
  float height_ = 0.0F;   // of the camera above the ground
  std::vector<FrameObject> objects_;
  std::vector<FrameBody> bodies_;                // front to back
  std::vector<std::vector<int>> object_bodies_;  // numbers of each frame object's bodies
  int tiles_x_ = 0, tiles_y_ = 0;
  std::vector<std::vector<int>> tile_bodies_, tile_shadows_;
};

}  // namespace penumbra::slam::synthetic
