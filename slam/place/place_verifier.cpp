#include "slam/place/place_verifier.h"

#include <algorithm>
#include <array>

#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/measurement.h"
#include "slam/geometry/pnp_ransac.h"
#include "slam/geometry/pose_optimizer.h"
#include "slam/map/projection.h"

namespace penumbra::slam {

namespace {

constexpr int kCellColumns = 8, kCellRows = 4;
constexpr float kWideRadius = 10.0F, kNarrowRadius = 4.0F;  // pixels at level 0

// Pairs of map points and features of the image.
struct Pairs {
  std::vector<MapPoint*> points;
  std::vector<int> features;
  std::vector<PoseObservation> observations;

  void add(MapPoint* point, int feature, const FeatureView& image, const std::vector<double>& scales) {
    points.push_back(point);
    features.push_back(feature);
    observations.push_back({point->position, measurement_of(image, feature, scales)});
  }
};

Pairs match_by_looks(const KeyFrame& keyframe, const FeatureView& image, const std::vector<double>& scales) {
  std::vector<Descriptor> descriptors;
  std::vector<MapPoint*> points;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    if (keyframe.points[i] == nullptr) continue;
    points.push_back(keyframe.points[i]);
    descriptors.push_back(keyframe.features->descriptor(static_cast<int>(i)));
  }
  Pairs pairs;
  for (const Match& match : match_descriptors(descriptors, image.measured().left.descriptors, {})) {
    if (image.is_movable(match.feature)) continue;
    pairs.add(points[static_cast<std::size_t>(match.source)], match.feature, image, scales);
  }
  return pairs;
}

// Whether something that may have come since then stands in front of a point, `depth` metres from the camera.
bool is_hidden(const Projection& projection, double depth, const Constellation& objects) {
  constexpr double kLength = 3.0;  // metres that an object reaches beyond its middle
  const int u = static_cast<int>(projection.u), v = static_cast<int>(projection.v);
  return std::any_of(objects.begin(), objects.end(), [&](const SeenObject& object) {
    return !object.stands && object.region.contains(u, v) && depth > object.position.z() + kLength;
  });
}

Pairs match_by_projection(const StereoCamera& camera, const SE3& T_cw, const std::vector<MapPoint*>& points,
                          const FeatureView& image, const Constellation& objects,
                          const std::vector<double>& scales, float radius, int& visible) {
  std::vector<Projection> projections;
  visible = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::optional<Projection> projection = project_point(camera, T_cw, *points[i], scales);
    if (!projection) continue;
    projection->source = static_cast<int>(i);
    projections.push_back(*projection);
    visible += !is_hidden(*projection, (T_cw * points[i]->position).z(), objects);
  }
  FrameMatcherSettings search;
  search.radius = radius;
  search.max_distance = 64;
  search.check_rotation = false;
  Pairs pairs;
  for (const Match& match : match_projections(projections, image, {}, scales, search)) {
    pairs.add(points[static_cast<std::size_t>(match.source)], match.feature, image, scales);
  }
  return pairs;
}

int occupied_cells(const StereoCamera& camera, const FeatureView& image,
                   const std::vector<MapPoint*>& points) {
  std::array<bool, kCellColumns * kCellRows> occupied{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i] == nullptr) continue;
    const FeaturePixel k = image.pixel(static_cast<int>(i));
    const int column = static_cast<int>(k.u) * kCellColumns / camera.width;
    const int row = static_cast<int>(k.v) * kCellRows / camera.height;
    occupied[static_cast<std::size_t>(std::clamp(row, 0, kCellRows - 1) * kCellColumns +
                                      std::clamp(column, 0, kCellColumns - 1))] = true;
  }
  return static_cast<int>(std::count(occupied.begin(), occupied.end(), true));
}

// What a pose must be proven with.
struct Proof {
  int inliers = 0;
  double share = 0.0;
  int cells = 0;
};

Proof lesser(const Proof& a, const Proof& b) {
  return {std::min(a.inliers, b.inliers), std::min(a.share, b.share), std::min(a.cells, b.cells)};
}

}  // namespace

std::vector<MapPoint*> points_around(const KeyFrame& keyframe, int neighbours) {
  std::vector<MapPoint*> points;
  const auto take = [&](const KeyFrame& from) {
    for (MapPoint* point : from.points) {
      if (point != nullptr) points.push_back(point);
    }
  };
  take(keyframe);
  for (int n = 0; n < neighbours && n < static_cast<int>(keyframe.covisibles.size()); ++n) {
    take(*keyframe.covisibles[static_cast<std::size_t>(n)].keyframe);
  }
  std::sort(points.begin(), points.end(), [](const MapPoint* a, const MapPoint* b) { return a->id < b->id; });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::optional<VerifiedPlace> verify_place(const Map& map, const FeatureView& features, KeyFrame* keyframe,
                                          std::uint64_t seed, const PlaceVerifierSettings& settings,
                                          const Constellation& objects) {
  const StereoCamera& camera = map.camera();
  const Proof by_points{settings.fewest_inliers, settings.least_share, settings.fewest_cells};
  const bool may_be_supported =
      settings.constellation.enabled && count_standing(objects) >= settings.constellation.fewest_agreeing;
  const Proof least =
      may_be_supported ? lesser(by_points, {settings.fewest_supported_inliers, settings.least_supported_share,
                                            settings.fewest_supported_cells})
                       : by_points;
  Pairs pairs = match_by_looks(*keyframe, features, map.scales());
  PnpRansacSettings ransac;
  ransac.seed = seed;
  ransac.fewest_inliers = settings.fewest_ransac_inliers;
  const std::optional<PnpResult> pnp = solve_pnp_ransac(camera, pairs.observations, ransac);
  if (!pnp) return std::nullopt;
  PoseEstimate estimate = optimize_pose(camera, *pnp, pairs.observations);
  if (estimate.inliers < settings.fewest_ransac_inliers) return std::nullopt;

  VerifiedPlace place;
  const std::vector<MapPoint*> points = points_around(*keyframe, settings.neighbours);
  bool enough_points = true;
  for (const float radius : {kWideRadius, kNarrowRadius}) {
    pairs = match_by_projection(camera, estimate.T_cw, points, features, objects, map.scales(), radius,
                                place.visible);
    estimate = optimize_pose(camera, estimate.T_cw, pairs.observations);
    if (estimate.inliers < least.inliers) return std::nullopt;
    enough_points = enough_points && estimate.inliers >= by_points.inliers;
  }
  place.keyframe = keyframe;
  place.T_cw = estimate.T_cw;
  place.inliers = estimate.inliers;
  place.points.assign(static_cast<std::size_t>(features.size()), nullptr);
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    if (estimate.inlier[i]) place.points[static_cast<std::size_t>(pairs.features[i])] = pairs.points[i];
  }
  // A pose may show more points than the image has features to find them with.
  const int findable = std::min(place.visible, features.size());
  const int cells = occupied_cells(camera, features, place.points);
  const auto proves = [&](const Proof& needed) {
    return !(place.inliers < needed.share * findable) && cells >= needed.cells;
  };
  if (enough_points && proves(by_points)) return place;
  if (!may_be_supported || !proves(least)) return std::nullopt;
  const ConstellationAgreement agreement = compare_constellations(
      camera, objects, constellation_around(*keyframe, settings.constellation.neighbours),
      place.T_cw * keyframe->T_cw.inverse(), settings.constellation);
  if (!supports_place(agreement, settings.constellation)) return std::nullopt;
  place.objects = agreement.agreeing;
  return place;
}

}  // namespace penumbra::slam
