// Renders what one camera sees of a synthetic world: colour, depth and instance ids.
//
// Every pixel's own values come from the ray through its centre (exact geometry, so depth and ids are true to
// the sample); pixels whose neighbours show another surface average the colour of four rays, placed on a
// rotated grid. Threads share two passes over tiles of the image: which surface is where, then its colour.
// No pixel depends on the order of the work, so the bytes are the same for any number of threads.
#pragma once

#include <array>

#include "nn/image/image.h"
#include "slam/world/frame_geometry.h"

namespace penumbra::slam::synthetic {

// Grey albedo, share of light that is mirrored, share of the sun's light that falls on it.
using Reflectance = std::array<float, 3>;

struct RenderedView {
  Image<Colour> radiance;  // linear red, green, blue
  FloatImage depth;        // metres along the optical axis; 0 = sky
  WordImage instance;      // Object::instance, 0 = background
  bool wants_reflectance = false;
  Image<Reflectance> reflectance;  // where wants_reflectance
  bool wants_objects = false;
  Image<std::int32_t> object;  // number in World::objects, -1 = none; where wants_objects
};

class RayCaster {
 public:
  explicit RayCaster(const World& world) : world_(world) {}

  // The view of a pinhole camera (the left one of `camera`; for the right one move T_wc by the baseline).
  // `view` is allocated on the first call and reused.
  void render(const StereoCamera& camera, const SE3& T_wc, double time, RenderedView& view);
  // The same of rows band * kTileHeight to (band + 1) * kTileHeight alone; the rest of `view` is kept. For
  // shutters that open row by row.
  void render_band(const StereoCamera& camera, const SE3& T_wc, double time, int band, RenderedView& view);
  // The world as the last call of render placed it.
  const FrameGeometry& geometry() const { return geometry_; }

 private:
  void render_tiles(int first, int end, RenderedView& view);
  void find_surfaces(int tile, RenderedView& view);
  void colour(int tile, RenderedView& view) const;
  bool is_edge(int column, int row) const;
  // `reflectance` may be null.
  Colour shade(float x, float y, float depth, std::int32_t surface, int tile, Reflectance* reflectance) const;
  float ground_light(const Eigen::Vector3f& camera_point, int tile, float& ambient) const;

  const World& world_;
  FrameGeometry geometry_;
  Image<std::int32_t> surfaces_;
  float pixel_ = 0.0F;               // size of a pixel at depth 1
  int first_row_ = 0, end_row_ = 0;  // that are rendered
};

}  // namespace penumbra::slam::synthetic
