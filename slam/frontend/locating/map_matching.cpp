#include "slam/frontend/locating/map_matching.h"

#include <algorithm>

#include "slam/frontend/features/measurement.h"
#include "slam/frontend/locating/feature_refiner.h"
#include "slam/map/projection.h"

namespace penumbra::slam {

std::vector<MapPoint*> match_map_points(const StereoCamera& camera, const std::vector<double>& scales,
                                        const std::vector<MapPoint*>& points, float radius, Frame& frame) {
  std::vector<MapPoint*> shown;
  std::vector<char> taken(frame.points.size(), 0);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.points[i] == nullptr) continue;
    taken[i] = 1;
    shown.push_back(frame.points[i]);
  }
  std::sort(shown.begin(), shown.end());

  std::vector<MapPoint*> looked_for = shown;
  std::vector<Projection> projections;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::binary_search(shown.begin(), shown.end(), points[i])) continue;
    std::optional<Projection> projection = project_point(camera, frame.T_cw, *points[i], scales);
    if (!projection) continue;
    looked_for.push_back(points[i]);
    projection->source = static_cast<int>(i);
    projections.push_back(*projection);
  }
  FrameMatcherSettings search;
  search.radius = radius;
  search.ratio = 0.8F;
  search.check_rotation = false;
  for (const Match& match : match_projections(projections, *frame.features, taken, scales, search)) {
    frame.points[static_cast<std::size_t>(match.feature)] = points[static_cast<std::size_t>(match.source)];
  }
  return looked_for;
}

std::vector<PoseObservation> refine_observations(const StereoCamera& camera,
                                                 const std::vector<double>& scales,
                                                 std::span<const LoosePoint> loose, Frame& frame) {
  const FeatureRefiner refiner(*frame.pyramid, scales);
  const auto refine = [&](int feature, const Eigen::Vector3d& point, const Patch& patch, double patch_depth) {
    const Eigen::Vector3d p = frame.T_cw * point;
    if (!(p.z() > 0.0)) return false;
    return refiner.refine(*frame.features, feature, patch, patch_depth, camera.project(p), p.z());
  };
  std::vector<PoseObservation> observations;
  const auto observe = [&](int feature, const Eigen::Vector3d& point, bool aligned) {
    observations.push_back({point, measurement_of(*frame.features, feature, scales, aligned)});
  };
  for (int i = 0; i < frame.features->size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    const MapPoint* point = frame.points[at];
    if (point == nullptr) continue;
    frame.aligned[at] = refine(i, point->position, point->patch, point->patch_depth);
    observe(i, point->position, frame.aligned[at]);
  }
  for (const LoosePoint& l : loose) {
    if (frame.points[static_cast<std::size_t>(l.feature)] != nullptr) continue;
    observe(l.feature, l.position, refine(l.feature, l.position, *l.patch, l.patch_depth));
  }
  return observations;
}

int keep_agreeing(const StereoCamera& camera, const std::vector<double>& scales,
                  std::span<const PoseObservation> observations, const PoseEstimate& estimate, Frame& frame) {
  int kept = 0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.points[i] == nullptr) continue;
    bool agrees = estimate.inlier[k];
    if (!agrees && frame.aligned[i]) {
      frame.aligned[i] = 0;
      const PixelMeasurement z = measurement_of(*frame.features, static_cast<int>(i), scales);
      const Eigen::Vector3d p = estimate.T_cw * observations[k].point;
      agrees = p.z() > 0.0 && reprojection_error(camera, p, z).squaredNorm() * z.inverse_variance <= z.gate();
    }
    ++k;
    if (agrees) {
      ++kept;
    } else {
      frame.points[i] = nullptr;
    }
  }
  return kept;
}

}  // namespace penumbra::slam
