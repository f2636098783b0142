#include "slam/dynamics/companion_finder.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "slam/dynamics/cluster_outline.h"
#include "slam/frontend/features/nearest_descriptor.h"

namespace penumbra::slam {

namespace {

constexpr double kClearlyMoved = 9.0;  // squared Mahalanobis distance: 3 sigma

bool travels(const PointOrigin& from, const PointOrigin& now, double least_speed) {
  const Eigen::Vector3d D = now.position - from.position;
  if (D.norm() < least_speed * (now.time - from.time)) return false;
  const Eigen::Matrix3d S = from.covariance + now.covariance;
  return D.dot(S.ldlt().solve(D)) > kClearlyMoved;
}

}  // namespace

// How little the new frame's features look like feature `i` of the past where its point is if it stands.
// Where that is out of sight, how little the others of the past do, one of which may have come to its place.
int CompanionFinder::distance_if_still(const Past& past, int i, const FeatureView& features,
                                       const SE3& T_co) const {
  constexpr float kRadius = 6.0F;  // pixels
  const FeatureView before = past.view();
  const Descriptor& looks = before.descriptor(i);
  int distance = 256;
  const Eigen::Vector3d p = T_co * past.origins[static_cast<std::size_t>(i)].position;
  const Eigen::Vector2d pixel = p.z() > 0.0 ? camera_.project(p) : Eigen::Vector2d(-1.0, -1.0);
  if (camera_.in_image(pixel)) {
    features.measured().grid.visit_near(
        static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), kRadius,
        [&](int j) { distance = std::min(distance, hamming_distance(looks, features.descriptor(j))); });
    return distance;
  }
  const FeaturePixel k = before.pixel(i);
  for (int j = 0; j < before.size(); ++j) {
    const FeaturePixel other = before.pixel(j);
    if (std::max(std::abs(other.u - k.u), std::abs(other.v - k.v)) <= kRadius) continue;
    distance = std::min(distance, hamming_distance(looks, before.descriptor(j)));
  }
  return distance;
}

// Per feature of the new frame: the point of the past frame that it shows.
std::vector<CompanionFinder::Found> CompanionFinder::found_again(const Past& past,
                                                                 const FeatureView& features,
                                                                 const SE3& T_co) const {
  std::vector<Found> found(static_cast<std::size_t>(features.size()));
  std::vector<int> distance_of(found.size(), settings_.max_distance + 1);
  const FeatureView before = past.view();
  for (int i = 0; i < before.size(); ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    if (!past.origins[at].known) continue;
    const FeaturePixel k = before.pixel(i);
    const double disparity = k.u - k.u_right;
    NearestDescriptor nearest = NearestDescriptor::within(settings_.max_distance + 1);
    features.measured().grid.visit_near(k.u, k.v, settings_.search_radius, [&](int j, int level) {
      if (std::abs(level - before.level(i)) > 1 || !features.has_stereo(j)) return;
      const FeaturePixel pixel = features.pixel(j);
      const double other = pixel.u - pixel.u_right;
      if (std::abs(other - disparity) > settings_.search_disparity) return;
      nearest.offer(j, hamming_distance(before.descriptor(i), features.descriptor(j)));
    });
    if (nearest.index < 0) continue;
    const auto best = static_cast<std::size_t>(nearest.index);
    if (nearest.distance >= distance_of[best]) continue;
    distance_of[best] = nearest.distance;
    found[best] = {past.origins[at],
                   nearest.distance + settings_.margin <= distance_if_still(past, i, features, T_co)};
  }
  return found;
}

std::optional<Instance> CompanionFinder::observe(std::shared_ptr<const FrameFeatures> features,
                                                 std::shared_ptr<const FeaturePixels> pixels,
                                                 const std::vector<char>& movable,
                                                 std::vector<PointOrigin> origins, const SE3& T_co,
                                                 double time, bool reliable) {
  if (!settings_.enabled) return std::nullopt;
  if (!reliable) past_.clear();
  while (!past_.empty() && !(time - past_.front().time < settings_.longest)) past_.pop_front();
  while (past_.size() > 1 && time - past_[1].time >= settings_.seconds) past_.pop_front();
  std::vector<Pixel> travelling, standing;
  if (!past_.empty() && time - past_.front().time >= settings_.seconds) {
    const FeatureView now(*features, pixels, movable);
    const std::vector<Found> found = found_again(past_.front(), now, T_co);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i].origin.known || !origins[i].known || now.is_movable(static_cast<int>(i))) continue;
      const FeaturePixel k = now.pixel(static_cast<int>(i));
      const bool moves = found[i].clearly && travels(found[i].origin, origins[i], settings_.least_speed);
      (moves ? travelling : standing)
          .push_back({static_cast<int>(std::lrint(k.u)), static_cast<int>(std::lrint(k.v))});
    }
  }
  past_.push_back({std::move(features), std::move(pixels), std::move(origins), time});
  if (static_cast<int>(travelling.size()) < settings_.fewest_features) return std::nullopt;
  const Size image{camera_.width, camera_.height};
  const ByteImage outline = outline_of_cluster(image, travelling, std::max(4, image.width / 18));
  const int own = count_inside(outline, travelling), foreign = count_inside(outline, standing);
  if (own < settings_.fewest_features || own < settings_.least_share * (own + foreign)) return std::nullopt;
  return outlined_instance(outline, own, foreign);
}

}  // namespace penumbra::slam
