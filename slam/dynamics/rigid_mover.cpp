#include "slam/dynamics/rigid_mover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "nn/base/quantile.h"
#include "slam/dynamics/cluster_outline.h"

namespace penumbra::slam {

namespace {

constexpr int kMostDraws = 150;
constexpr double kFewestOfRest = 0.35;    // share of the rest that must agree on the second motion
constexpr double kClearlyOff = 4.0;       // times the gate: a pair that a motion does not explain
constexpr double kMostWorldInside = 0.4;  // points of the world in the mover's outline, as a share of its own
constexpr double kFarthest = 60.0;        // metres; farther points say nothing about extents

// Relative to the gate.
double squared_error(const StereoCamera& camera, const SE3& T_cw, const PoseObservation& o) {
  const Eigen::Vector3d p = T_cw * o.point;
  if (!(p.z() > 0.0)) return std::numeric_limits<double>::infinity();
  return weighted_error(camera, p, o.measurement) / o.measurement.gate();
}

// Pairs that `own` explains and `other` clearly does not.
std::vector<std::size_t> explained_only_by(const StereoCamera& camera,
                                           std::span<const PoseObservation> observations, const SE3& own,
                                           const SE3& other) {
  std::vector<std::size_t> only;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (squared_error(camera, own, observations[i]) <= 1.0 &&
        squared_error(camera, other, observations[i]) > kClearlyOff)
      only.push_back(i);
  }
  return only;
}

double bulk(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile_of_sorted(values, 0.9) - quantile_of_sorted(values, 0.1);
}

bool fits_into_vehicle(std::span<const PoseObservation> observations, const std::vector<std::size_t>& points,
                       const SE3& T_cw, const RigidMoverSettings& settings) {
  std::vector<double> x, y, z;
  for (const std::size_t i : points) {
    const Eigen::Vector3d p = T_cw * observations[i].point;
    if (p.z() > kFarthest) continue;
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
  if (2 * x.size() < points.size() || x.empty()) return false;
  return bulk(x) <= settings.width && bulk(y) <= settings.height && bulk(z) <= settings.length;
}

std::vector<Pixel> pixels_of(std::span<const PoseObservation> observations,
                             const std::vector<std::size_t>& points) {
  std::vector<Pixel> pixels;
  for (const std::size_t i : points) {
    const Eigen::Vector3d& pixel = observations[i].measurement.pixel;
    pixels.push_back({static_cast<int>(std::lrint(pixel.x())), static_cast<int>(std::lrint(pixel.y()))});
  }
  return pixels;
}

// Describes the mover, if the points in its outline are mostly its own.
bool describe_mover(const StereoCamera& camera, std::span<const PoseObservation> observations,
                    const std::vector<std::size_t>& own, const std::vector<std::size_t>& others,
                    const SE3& T_cw, SeparatedMotions& motions) {
  const std::vector<Pixel> pixels = pixels_of(observations, own);
  const ByteImage outline =
      outline_of_cluster({camera.width, camera.height}, pixels, std::max(4, camera.width / 40));
  const int inside = count_inside(outline, pixels);
  const int foreign = count_inside(outline, pixels_of(observations, others));
  if (foreign > kMostWorldInside * inside) return false;
  std::optional<Instance> mover = outlined_instance(outline, inside, foreign);
  if (!mover) return false;
  std::vector<double> depths;
  for (const std::size_t i : own) depths.push_back((T_cw * observations[i].point).z());
  std::sort(depths.begin(), depths.end());
  motions.nearest = 0.9 * quantile_of_sorted(depths, 0.1) - 0.5;
  motions.farthest = 1.1 * quantile_of_sorted(depths, 0.9) + 0.5;
  motions.mover = std::move(mover);
  return true;
}

}  // namespace

SeparatedMotions separate_motions(const StereoCamera& camera, std::span<const PoseObservation> observations,
                                  const PoseEstimate& dominant, const std::optional<SE3>& predicted,
                                  std::uint64_t seed, const RigidMoverSettings& settings) {
  SeparatedMotions motions;
  motions.world = dominant;
  if (!settings.enabled || dominant.inlier.size() != observations.size()) return motions;
  std::vector<PoseObservation> rest;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (squared_error(camera, dominant.T_cw, observations[i]) > kClearlyOff) rest.push_back(observations[i]);
  }
  const double fewest = std::max(static_cast<double>(settings.fewest_points),
                                 settings.least_share * static_cast<double>(observations.size()));
  if (static_cast<double>(rest.size()) < fewest) return motions;
  PnpRansacSettings ransac;
  ransac.seed = seed;
  ransac.most_draws = kMostDraws;
  ransac.fewest_inliers =
      std::max(settings.fewest_points, static_cast<int>(kFewestOfRest * static_cast<double>(rest.size())));
  const std::optional<PnpResult> found = solve_pnp_ransac(camera, rest, ransac);
  if (!found) return motions;
  const PoseEstimate second = optimize_pose(camera, found->T_cw, rest);
  if ((second.T_cw * dominant.T_cw.inverse()).translation.norm() < settings.least_motion) return motions;

  const std::vector<std::size_t> first_only =
      explained_only_by(camera, observations, dominant.T_cw, second.T_cw);
  const std::vector<std::size_t> second_only =
      explained_only_by(camera, observations, second.T_cw, dominant.T_cw);
  if (static_cast<double>(second_only.size()) < fewest) return motions;
  const bool first_fits = fits_into_vehicle(observations, first_only, dominant.T_cw, settings);
  const bool second_fits = fits_into_vehicle(observations, second_only, second.T_cw, settings);
  bool swap = first_fits && !second_fits;
  if (first_fits && second_fits && predicted) {
    const auto surprise = [&](const SE3& T) { return (T * predicted->inverse()).translation.norm(); };
    swap = surprise(second.T_cw) < 0.5 * surprise(dominant.T_cw);
  }
  if (!swap) {
    if (second_fits) describe_mover(camera, observations, second_only, first_only, second.T_cw, motions);
    return motions;
  }
  if (!describe_mover(camera, observations, first_only, second_only, dominant.T_cw, motions)) return motions;
  // The world's pose from everything but the mover's points.
  std::vector<PoseObservation> others;
  std::vector<std::size_t> place;
  std::size_t next = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (next < first_only.size() && first_only[next] == i) {
      ++next;
      continue;
    }
    others.push_back(observations[i]);
    place.push_back(i);
  }
  const PoseEstimate world = optimize_pose(camera, second.T_cw, others);
  motions.world.T_cw = world.T_cw;
  motions.world.inliers = world.inliers;
  motions.world.inlier.assign(observations.size(), 0);
  for (std::size_t k = 0; k < place.size(); ++k) motions.world.inlier[place[k]] = world.inlier[k];
  return motions;
}

void mark_mover(const SeparatedMotions& motions, const FeatureView& features, std::vector<char>& movable) {
  for (int i = 0; i < features.size(); ++i) {
    const FeaturePixel pixel = features.pixel(i);
    const double depth = features.depth(i);
    if (features.has_stereo(i) && (depth < motions.nearest || depth > motions.farthest)) continue;
    if (motions.mover->contains(static_cast<int>(std::lrint(pixel.u)), static_cast<int>(std::lrint(pixel.v))))
      movable[static_cast<std::size_t>(i)] = 1;
  }
}

}  // namespace penumbra::slam
