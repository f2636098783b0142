#include "slam/map/dense/displaced.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace penumbra::slam {

namespace {

constexpr int kFewestTold = 20;         // places
constexpr double kContradiction = 0.5;  // share of those that are seen through
constexpr int kContradictingViews = 2;
constexpr int kFewestViews = 4;   // of which one must confirm
constexpr int kMostPlaces = 400;  // of a thing

// Where its pixels are in the world.
std::vector<Eigen::Vector3d> places_of(const PosedView& from, int step, const Rect& region,
                                       const ByteImage& mask, double farthest) {
  const DenseView& view = *from.view;
  std::vector<Eigen::Vector3d> places;
  const int apart = std::max(1, static_cast<int>(std::sqrt(region.area() / kMostPlaces)) / step) * step;
  for (int v = region.y; v < region.y + region.height; v += apart) {
    for (int u = region.x; u < region.x + region.width; u += apart) {
      const int x = (u - region.x) * mask.width() / region.width;
      const int y = (v - region.y) * mask.height() / region.height;
      const int column = u / step, row = v / step;
      if (column >= view.depth.width() || row >= view.depth.height() || mask.at(x, y) == 0) continue;
      const auto z = static_cast<double>(view.depth_at(column, row));
      if (z > 0.0 && z <= farthest) places.push_back(from.T_wc * view.camera.back_project(column, row, z));
    }
  }
  return places;
}

struct Told {
  int same = 0, through = 0;  // places

  bool contradicts() const { return through >= kFewestTold && through >= kContradiction * (same + through); }
  bool confirms() const { return same >= kFewestTold && same > kContradiction * (same + through); }
};

// What a view shows at these places.
Told look_up(const PosedView& posed, std::span<const Eigen::Vector3d> places,
             const FusionSettings& settings) {
  const DenseView& view = *posed.view;
  const SE3 T_cw = posed.T_wc.inverse();
  Told told;
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector3d p = T_cw * place;
    if (p.z() < 0.1) continue;
    const int column = static_cast<int>(std::lround(view.camera.fx * p.x() / p.z() + view.camera.cx));
    const int row = static_cast<int>(std::lround(view.camera.fy * p.y() / p.z() + view.camera.cy));
    if (column < 0 || row < 0 || column >= view.depth.width() || row >= view.depth.height()) continue;
    const double z = view.depth_at(column, row);
    if (z <= 0.0) continue;
    const double slack = 3.0 * settings.depth_noise * z * z + 2.0 * settings.voxel;
    told.same += std::abs(z - p.z()) <= slack;
    told.through += nearest_depth(view, column, row) > p.z() + slack;
  }
  return told;
}

}  // namespace

bool is_displaced(const PosedView& from, int step, const Rect& region, const ByteImage& mask,
                  std::span<const PosedView> views, const FusionSettings& settings) {
  if (mask.empty() || region.empty()) return false;
  const std::vector<Eigen::Vector3d> places = places_of(from, step, region, mask, settings.farthest);
  if (std::ssize(places) < kFewestTold) return false;
  int contradicting = 0, confirming = 0;
  for (const PosedView& view : views) {
    if (view.view == from.view) continue;
    const Told told = look_up(view, places, settings);
    contradicting += told.contradicts();
    confirming += told.confirms();
  }
  return contradicting >= kContradictingViews || (confirming == 0 && std::ssize(views) >= kFewestViews);
}

}  // namespace penumbra::slam
