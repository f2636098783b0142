#include "slam/frontend/locating/map_matching.h"

#include <algorithm>

#include "slam/frontend/features/measurement.h"
#include "slam/frontend/locating/feature_refiner.h"
#include "slam/map/projection.h"

namespace penumbra::slam {

void match_map_points(const StereoCamera& camera, const std::vector<double>& scales,
                      const std::vector<MapPoint*>& points, float radius, const Frame& frame,
                      Hypothesis& hypothesis) {
  std::vector<MapPoint*> shown;
  std::vector<char> taken(hypothesis.points.size(), 0);
  shown.reserve(hypothesis.points.size());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (hypothesis.points[i] == nullptr) continue;
    taken[i] = 1;
    shown.push_back(hypothesis.points[i]);
  }
  std::sort(shown.begin(), shown.end(), [](const MapPoint* a, const MapPoint* b) { return a->id < b->id; });

  hypothesis.looked_for = shown;
  hypothesis.looked_for.reserve(shown.size() + points.size());
  std::vector<Projection> projections;
  projections.reserve(points.size());
  auto next_shown = shown.begin();  // both are in the order of their ids
  for (std::size_t i = 0; i < points.size(); ++i) {
    while (next_shown != shown.end() && (*next_shown)->id < points[i]->id) ++next_shown;
    if (next_shown != shown.end() && *next_shown == points[i]) continue;
    std::optional<Projection> projection = project_point(camera, hypothesis.T_cw, *points[i], scales);
    if (!projection) continue;
    hypothesis.looked_for.push_back(points[i]);
    projection->source = static_cast<int>(i);
    projections.push_back(*projection);
  }
  FrameMatcherSettings search;
  search.radius = radius;
  search.ratio = 0.8F;
  search.check_rotation = false;
  for (const Match& match : match_projections(projections, hypothesis.view(frame), taken, scales, search)) {
    hypothesis.points[static_cast<std::size_t>(match.feature)] =
        points[static_cast<std::size_t>(match.source)];
  }
}

std::vector<PoseObservation> refine_observations(const StereoCamera& camera,
                                                 const std::vector<double>& scales, const Frame& frame,
                                                 Hypothesis& hypothesis) {
  const FeatureRefiner refiner(*frame.pyramid, scales);
  const auto refine = [&](int feature, const Eigen::Vector3d& point, const Patch& patch, double patch_depth) {
    const Eigen::Vector3d p = hypothesis.T_cw * point;
    if (!(p.z() > 0.0)) return false;
    return refiner.refine(hypothesis.pixels[static_cast<std::size_t>(feature)],
                          frame.features->keypoint(feature).level, patch, patch_depth, camera.project(p),
                          p.z());
  };
  std::vector<PoseObservation> observations;
  observations.reserve(hypothesis.points.size());
  const auto observe = [&](int feature, const Eigen::Vector3d& point, bool aligned) {
    observations.push_back({point, measurement_of(hypothesis.view(frame), feature, scales, aligned)});
  };
  for (int i = 0; i < frame.features->size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    const MapPoint* point = hypothesis.points[at];
    if (point == nullptr) continue;
    hypothesis.aligned[at] = refine(i, point->position, point->patch, point->patch_depth);
    observe(i, point->position, hypothesis.aligned[at]);
  }
  for (const LoosePoint& l : hypothesis.loose) {
    if (hypothesis.points[static_cast<std::size_t>(l.feature)] != nullptr) continue;
    observe(l.feature, l.position, refine(l.feature, l.position, *l.patch, l.patch_depth));
  }
  return observations;
}

int keep_agreeing(const StereoCamera& camera, const std::vector<double>& scales,
                  std::span<const PoseObservation> observations, const PoseEstimate& estimate,
                  const Frame& frame, Hypothesis& hypothesis) {
  int kept = 0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < hypothesis.points.size(); ++i) {
    if (hypothesis.points[i] == nullptr) continue;
    bool agrees = estimate.inlier[k];
    if (!agrees && hypothesis.aligned[i]) {
      hypothesis.aligned[i] = 0;
      const PixelMeasurement z = measurement_of(hypothesis.view(frame), static_cast<int>(i), scales);
      const Eigen::Vector3d p = estimate.T_cw * observations[k].point;
      agrees = within_gate(camera, p, z);
    }
    ++k;
    if (agrees) {
      ++kept;
    } else {
      hypothesis.points[i] = nullptr;
    }
  }
  return kept;
}

}  // namespace penumbra::slam
