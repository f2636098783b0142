#include "slam/map/dense/fusion.h"

#include <algorithm>
#include <limits>

#include "nn/base/parallel.h"

namespace penumbra::slam {

namespace {

void measure(const PosedView& posed, std::uint32_t number, const FusionSettings& settings, VoxelGrid& grid) {
  const DenseView& view = *posed.view;
  const Eigen::Matrix3f rotation = posed.T_wc.rotation.cast<float>();
  const Eigen::Vector3f translation = posed.T_wc.translation.cast<float>();
  const auto fx = static_cast<float>(view.camera.fx), fy = static_cast<float>(view.camera.fy);
  const auto cx = static_cast<float>(view.camera.cx), cy = static_cast<float>(view.camera.cy);
  const auto noise = static_cast<float>(settings.depth_noise);
  const auto farthest = static_cast<float>(settings.farthest);
  for (int row = 0; row < view.depth.height(); ++row) {
    const float y = (static_cast<float>(row) - cy) / fy;
    const std::uint8_t* colours = view.colour.row(row);
    for (int column = 0; column < view.depth.width(); ++column, colours += 3) {
      const float z = view.depth_at(column, row);
      const std::uint8_t label = view.label.at(column, row);
      if (z <= 0.0F || z > farthest || label == kMoves) continue;
      const float sigma = noise * z * z;
      SurfaceSample point;
      point.place =
          rotation * Eigen::Vector3f((static_cast<float>(column) - cx) / fx * z, y * z, z) + translation;
      point.weight = 1.0F / (sigma * sigma);
      point.colour = {static_cast<float>(colours[0]), static_cast<float>(colours[1]),
                      static_cast<float>(colours[2])};
      point.class_id = label;
      grid.add(point, number);
    }
  }
}

// Counts, per voxel, whether the view looks through it.
void look_through(const PosedView& posed, const FusionSettings& settings, VoxelGrid& grid) {
  const StereoCamera& camera = posed.view->camera;
  const FloatImage nearest = nearest_depths(*posed.view);
  const SE3 T_cw = posed.T_wc.inverse();
  const Eigen::Matrix3f rotation = T_cw.rotation.cast<float>();
  const Eigen::Vector3f translation = T_cw.translation.cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto noise = static_cast<float>(settings.depth_noise);
  const float slack = 2.0F * static_cast<float>(settings.voxel);
  std::vector<Voxel>& voxels = grid.voxels();
  parallel_for(voxels.size(), 2048, [&](std::size_t i) {
    Voxel& voxel = voxels[i];
    const Eigen::Vector3f p = rotation * voxel.place + translation;
    if (p.z() < 0.1F) return;
    const float u = fx * p.x() / p.z() + cx + 0.5F, v = fy * p.y() / p.z() + cy + 0.5F;
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(nearest.width()) &&
          v < static_cast<float>(nearest.height())))
      return;
    const float behind = nearest.at(static_cast<int>(u), static_cast<int>(v));
    if (behind > p.z() + 3.0F * noise * behind * behind + slack &&
        voxel.seen_through < std::numeric_limits<std::uint16_t>::max()) {
      ++voxel.seen_through;
    }
  });
}

}  // namespace

VoxelGrid fuse(std::span<const PosedView> views, const FusionSettings& settings) {
  VoxelGrid grid(settings.voxel);
  std::uint32_t number = 0;
  for (const PosedView& view : views) measure(view, ++number, settings, grid);
  for (const PosedView& view : views) look_through(view, settings, grid);
  grid.remove_if([&](const Voxel& voxel) {
    const double empty = settings.seen_through * voxel.views;
    return voxel.views < settings.fewest_views || (voxel.seen_through > 0 && voxel.seen_through >= empty);
  });
  return grid;
}

}  // namespace penumbra::slam
