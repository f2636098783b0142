#include "slam/brain/templates/place_geometry.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <utility>

#include "nn/base/quantile.h"
#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/measurement.h"
#include "slam/geometry/pose_optimizer.h"

namespace penumbra::slam::brain {

namespace {

// Whether a robot that stays on the ground can have moved so.
bool is_on_the_ground(const SE3& T, const PlaceGeometrySettings& settings) {
  constexpr double kClimb = 0.3;  // metres that a kerb and the camera's shaking make
  const double length = T.translation.norm();
  if (std::abs(T.translation.y()) > kClimb + settings.most_climb * length) return false;
  // The y axes of both cameras point down.
  return std::acos(std::clamp(T.rotation(1, 1), -1.0, 1.0)) <= settings.most_tilt;
}

}  // namespace

std::vector<PlacePoint> place_points(const StereoCamera& camera, const FrameFeatures& features,
                                     const PlaceGeometrySettings& settings) {
  const float farthest = static_cast<float>(settings.farthest * camera.baseline);
  std::vector<std::pair<float, int>> by_depth;
  for (int i = 0; i < features.size(); ++i) {
    const float depth = features.depth[static_cast<std::size_t>(i)];
    if (depth > 0.0F && depth <= farthest) by_depth.emplace_back(depth, i);
  }
  const std::size_t kept = std::min(by_depth.size(), static_cast<std::size_t>(settings.most_points));
  std::partial_sort(by_depth.begin(), by_depth.begin() + static_cast<std::ptrdiff_t>(kept), by_depth.end());
  std::vector<PlacePoint> points;
  points.reserve(kept);
  for (std::size_t n = 0; n < kept; ++n) {
    const Keypoint& k = features.keypoint(by_depth[n].second);
    const Eigen::Vector3d p =
        camera.back_project(static_cast<double>(k.u), static_cast<double>(k.v), by_depth[n].first);
    points.push_back({features.descriptor(by_depth[n].second),
                      {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())},
                      0.0F});
  }
  return points;
}

double median_distance(const std::vector<PlacePoint>& points) {
  std::vector<double> distances;
  for (const PlacePoint& point : points) distances.push_back(static_cast<double>(point.position[2]));
  return quantile_of(std::move(distances), 0.5);
}

std::optional<ProvenPlace> prove_place(const StereoCamera& camera, const std::vector<PlacePoint>& place,
                                       const FrameFeatures& now, const std::vector<double>& scales,
                                       std::uint64_t seed, const PlaceGeometrySettings& settings,
                                       const CameraMount& mount) {
  std::vector<slam::Descriptor> descriptors;
  descriptors.reserve(place.size());
  for (const PlacePoint& point : place) descriptors.push_back(point.descriptor);
  const FeatureView view(now);
  std::vector<PoseObservation> pairs;
  for (const Match& match : match_descriptors(descriptors, now.left.descriptors, {})) {
    const std::array<float, 3>& p = place[static_cast<std::size_t>(match.source)].position;
    PixelMeasurement measured = measurement_of(view, match.feature, scales);
    // The template's own depth is no better known than the image's.
    measured.inverse_variance *= 0.25;
    pairs.push_back({Eigen::Vector3d(p[0], p[1], p[2]), measured});
  }
  PnpRansacSettings ransac;
  ransac.seed = seed;
  ransac.most_draws = 100;
  ransac.fewest_inliers = settings.fewest_inliers;
  const std::optional<PnpResult> pnp = solve_pnp_ransac(camera, pairs, ransac);
  if (!pnp) return std::nullopt;
  const PoseEstimate estimate = optimize_pose(camera, *pnp, pairs);
  ProvenPlace proven;
  proven.inliers = estimate.inliers;
  proven.share = estimate.inliers / static_cast<double>(pairs.size());
  if (proven.inliers < settings.fewest_inliers || proven.share < settings.least_share) return std::nullopt;
  std::bitset<8> columns;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!estimate.inlier[i]) continue;
    const int column = static_cast<int>(8.0 * pairs[i].measurement.pixel.x() / camera.width);
    columns.set(static_cast<std::size_t>(std::clamp(column, 0, 7)));
  }
  if (static_cast<int>(columns.count()) < settings.fewest_columns) return std::nullopt;
  const SE3 T_place_now = mount.to_robot(estimate.T_cw.inverse());
  if (!is_on_the_ground(T_place_now, settings)) return std::nullopt;
  proven.motion = plane_pose(T_place_now);
  return proven;
}

}  // namespace penumbra::slam::brain
