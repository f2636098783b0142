#include "slam/world/depth_sensor.h"

#include <algorithm>
#include <cmath>

#include "nn/base/parallel.h"
#include "slam/world/camera_sensor.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

// Makes holes of what the projector, to the right of the camera, cannot light. A point of column u lies at
// u - fx b / Z in the projector's image. Along a row from right to left these places fall; a point whose
// place does not lie left of all before it is hidden from the projector by a nearer one.
void cast_projector_shadow(const RenderedView& view, const StereoCamera& camera, int row, FloatImage& depth) {
  const auto shift = static_cast<float>(camera.fx * kProjectorBaseline);
  float leftmost = 1e9F;
  for (int column = view.depth.width() - 1; column >= 0; --column) {
    const float z = view.depth.at(column, row);
    if (z <= 0.0F) continue;
    const float place = static_cast<float>(column) - shift / z;
    if (place >= leftmost) {
      depth.at(column, row) = 0.0F;
    } else {
      leftmost = place;
    }
  }
}

}  // namespace

void sense_depth(const RenderedView& view, const StereoCamera& camera, std::uint32_t seed,
                 FloatImage& depth) {
  depth.create(view.depth.width(), view.depth.height());
  parallel_for(depth.height(), 8, [&](int row) {
    for (int column = 0; column < depth.width(); ++column) {
      const float z = view.depth.at(column, row);
      float& sensed = depth.at(column, row) = 0.0F;
      if (z < kNearestSensed || z > kFarthestSensed) continue;
      const float albedo = view.reflectance.at(column, row)[0],
                  mirrored = view.reflectance.at(column, row)[1];
      // Little comes back from far, dark or shiny places; patches of about 5 pixels decide who is lost.
      const float dark = 1.0F - smooth_step(0.015F, 0.07F, albedo);
      const float shiny = smooth_step(0.08F, 0.25F, mirrored);
      const float loss = std::max(dark, shiny) * (0.6F + 0.4F * z / kFarthestSensed);
      const auto x = static_cast<float>(column), y = static_cast<float>(row);
      const float patch = 0.5F + 0.5F * value_noise(0.2F * x, 0.2F * y, seed);
      if (loss > patch) continue;
      const auto pixel = static_cast<std::uint32_t>(row * depth.width() + column);
      sensed = z + kDepthNoise * z * z * gaussian_noise(hash_of(pixel, seed));
    }
    cast_projector_shadow(view, camera, row, depth);
  });
}

}  // namespace penumbra::slam::synthetic
