#include "slam/backend/point_fusion.h"

#include "slam/frontend/features/measurement.h"
#include "slam/map/projection.h"

namespace penumbra::slam {

int fuse_points(Map& map, KeyFrame* keyframe, const std::vector<MapPoint*>& points, float radius,
                bool keep_given) {
  FrameMatcherSettings settings;
  settings.radius = radius;
  settings.max_distance = 50;
  settings.ratio = 1.0F;
  settings.check_rotation = false;
  std::vector<Projection> projections;
  for (std::size_t i = 0; i < points.size(); ++i) {
    MapPoint* point = points[i];
    if (point == nullptr || point->erased || observing_feature(*point, *keyframe) >= 0) continue;
    std::optional<Projection> projection = project_point(map.camera(), keyframe->T_cw, *point, map.scales());
    if (!projection) continue;
    projection->source = static_cast<int>(i);
    projections.push_back(*projection);
  }
  int found = 0;
  for (const Match& match : match_projections(projections, keyframe->view(), {}, map.scales(), settings)) {
    MapPoint* point = points[static_cast<std::size_t>(match.source)];
    if (point->erased) continue;
    const PixelMeasurement z = measurement_of(keyframe->view(), match.feature, map.scales());
    if (!within_gate(map.camera(), keyframe->T_cw * point->position, z)) continue;
    ++found;
    MapPoint* present = keyframe->points[static_cast<std::size_t>(match.feature)];
    if (present == nullptr) {
      map.add_observation(point, keyframe, match.feature);
    } else if (!keep_given && present->observations.size() >= point->observations.size()) {
      map.merge_points(point, present);
    } else {
      map.merge_points(present, point);
    }
  }
  return found;
}

}  // namespace penumbra::slam
