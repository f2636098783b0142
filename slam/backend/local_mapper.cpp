#include "slam/backend/local_mapper.h"

#include <algorithm>
#include <mutex>
#include <shared_mutex>

#include "slam/backend/point_fusion.h"

namespace penumbra::slam {

namespace {

// A point is on probation until this many keyframes have followed the one that made it.
constexpr int kProbation = 3;
// Views that a point needs to stay, where a stereo view counts twice.
constexpr int kLeastWeight = 4;
// Pixels at level 0 around a projection in which the same point is looked for.
constexpr float kFusionRadius = 3.0F;

int weight_of(const MapPoint& point) {
  int weight = 0;
  for (const Observation& o : point.observations)
    weight += o.keyframe->features->has_stereo(o.feature) ? 2 : 1;
  return weight;
}

}  // namespace

void LocalMapper::insert(KeyFrame* keyframe, const std::vector<MapPoint*>& tracked,
                         const std::vector<char>& aligned) {
  connect(keyframe, tracked, aligned);
  create_stereo_points(keyframe, map_, settings_.point_creation);
  renew_patches(keyframe);
}

void LocalMapper::process(KeyFrame* keyframe, const std::atomic<bool>* hurry, StageTimer& timer) {
  std::unique_lock lock(map_.mutex());
  cull_recent_points(*keyframe);
  {
    const auto scope = timer.measure("triangulation");
    triangulate_with_neighbours(keyframe, map_, settings_.point_creation);
  }
  {
    const auto scope = timer.measure("fusion");
    fuse_with_neighbours(keyframe);
  }
  give_patches(keyframe);
  {
    const auto scope = timer.measure("local_bundle");
    adjust_local_bundle(keyframe, map_, settings_.bundle, &lock, hurry);
  }
  const auto scope = timer.measure("keyframe_culling");
  cull_keyframes(*keyframe);
}

void LocalMapper::connect(KeyFrame* keyframe, const std::vector<MapPoint*>& tracked,
                          const std::vector<char>& aligned) {
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    MapPoint* point = tracked[i];
    if (point == nullptr || point->erased) continue;
    map_.add_observation(point, keyframe, static_cast<int>(i), aligned[i] != 0);
    map_.update_point(point);
  }
  map_.update_covisibility(keyframe);
}

void LocalMapper::cull_recent_points(const KeyFrame& newest) {
  // The points are in the order of their ids, and nearly so of their keyframes: one that was inserted
  // meanwhile may have made some before this one's were triangulated.
  const auto& points = map_.points();
  auto at = std::lower_bound(points.begin(), points.end(), first_unproven_,
                             [](const std::unique_ptr<MapPoint>& p, int id) { return p->id < id; });
  bool all_proven = true;
  for (; at != points.end(); ++at) {
    MapPoint* point = at->get();
    const int age = newest.id - point->first_keyframe;
    all_proven = all_proven && age >= kProbation;
    if (all_proven) first_unproven_ = point->id + 1;
    if (point->erased) continue;
    const bool seldom_found = point->found_ratio() < settings_.least_found_ratio;
    const bool seldom_seen = age >= kProbation - 1 && weight_of(*point) < kLeastWeight;
    if (seldom_found || seldom_seen) map_.erase_point(point);
  }
}

void LocalMapper::fuse_with_neighbours(KeyFrame* keyframe) {
  const std::vector<Covisible> covisibles = keyframe->covisibles;
  for (int n = 0; n < settings_.fuse_neighbours && n < static_cast<int>(covisibles.size()); ++n) {
    KeyFrame* neighbour = covisibles[static_cast<std::size_t>(n)].keyframe;
    fuse_points(map_, neighbour, std::vector<MapPoint*>(keyframe->points), kFusionRadius);
    fuse_points(map_, keyframe, std::vector<MapPoint*>(neighbour->points), kFusionRadius);
  }
  // The bundle adjustment that follows moves them all, and their views with them.
  for (MapPoint* point : keyframe->points) {
    if (point != nullptr && !point->descriptor_is_current) map_.update_point(point);
  }
  map_.update_covisibility(keyframe);
}

// A point is looked for as it was seen last. Where its old patch was not found its place is not known
// exactly: then the old one stays, unless the point has come so near that it cannot be found again.
void LocalMapper::renew_patches(KeyFrame* keyframe) {
  if (!keyframe->patches) return;
  constexpr double kNearer = 1.5;
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    MapPoint* point = keyframe->points[i];
    if (point == nullptr) continue;
    const double depth = (keyframe->T_cw * point->position).z();
    if (!keyframe->aligned[i] && !point->patch.empty() && point->patch_depth < kNearer * depth) continue;
    point->patch = (*keyframe->patches)[i];
    point->patch_depth = depth;
  }
}

// The points that the keyframe has got since it was inserted; the others may show how newer ones see them.
void LocalMapper::give_patches(KeyFrame* keyframe) {
  if (!keyframe->patches) return;
  for (std::size_t i = 0; i < keyframe->points.size(); ++i) {
    MapPoint* point = keyframe->points[i];
    if (point == nullptr || !point->patch.empty()) continue;
    point->patch = (*keyframe->patches)[i];
    point->patch_depth = (keyframe->T_cw * point->position).z();
  }
  keyframe->patches.reset();
}

void LocalMapper::cull_keyframes(const KeyFrame& newest) {
  const double close = close_depth(map_.camera(), settings_.point_creation);
  for (const Covisible& c : std::vector<Covisible>(newest.covisibles)) {
    // The one before the newest stays: the tracker may still lean on it.
    if (c.keyframe->id == 0 || c.keyframe->id >= newest.id - 1) continue;
    if (is_redundant(*c.keyframe, close, settings_.culling)) map_.erase_keyframe(c.keyframe);
  }
}

}  // namespace penumbra::slam
