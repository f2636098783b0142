#include "slam/map/map.h"

#include <algorithm>
#include <cstdint>

#include "slam/map/keyframe_table.h"

namespace penumbra::slam {

namespace {

// Keyframes that share fewer points are no neighbours, except the best one.
constexpr int kFewestShared = 15;

std::vector<Observation>::const_iterator lower_bound(const MapPoint& point, const KeyFrame& keyframe) {
  return std::lower_bound(point.observations.begin(), point.observations.end(), keyframe.id,
                          [](const Observation& o, int id) { return o.keyframe->id < id; });
}

// By shared points, and by age where they are equal: independent of addresses.
bool comes_first(const Covisible& a, const Covisible& b) {
  return a.shared_points != b.shared_points ? a.shared_points > b.shared_points
                                            : a.keyframe->id < b.keyframe->id;
}

void remove_edge(KeyFrame* from, const KeyFrame* to) {
  std::erase_if(from->covisibles, [&](const Covisible& c) { return c.keyframe == to; });
}

// The descriptor with the smallest median distance to the others; of equals that of the oldest keyframe.
Descriptor typical_descriptor(const MapPoint& point) {
  const std::size_t n = point.observations.size();
  thread_local std::vector<Descriptor> descriptors;
  thread_local std::vector<std::uint16_t> distances;  // n rows of n
  descriptors.clear();
  for (const Observation& o : point.observations)
    descriptors.push_back(o.keyframe->features->descriptor(o.feature));
  distances.assign(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      distances[i * n + j] = distances[j * n + i] =
          static_cast<std::uint16_t>(hamming_distance(descriptors[i], descriptors[j]));
    }
  }
  std::uint16_t best_median = kDescriptorBits + 1;
  std::size_t best = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = distances.begin() + static_cast<std::ptrdiff_t>(i * n),
               end = row + static_cast<std::ptrdiff_t>(n);
    // The median is below the best where more than half are: few rows need be sorted.
    std::uint16_t below = 0;
    for (auto d = row; d != end; ++d) below = static_cast<std::uint16_t>(below + (*d < best_median));
    if (below <= n / 2) continue;
    const auto middle = row + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(row, middle, end);
    best_median = *middle;
    best = i;
  }
  return descriptors[best];
}

}  // namespace

int observing_feature(const MapPoint& point, const KeyFrame& keyframe) {
  const auto at = lower_bound(point, keyframe);
  return at != point.observations.end() && at->keyframe == &keyframe ? at->feature : -1;
}

int Map::next_object_number() const {
  int next = 0;
  for (const KeyFrame* keyframe : active_keyframes_) {
    for (const SeenObject& object : keyframe->objects) next = std::max(next, object.number + 1);
  }
  return next;
}

std::unique_ptr<KeyFrame> Map::new_keyframe(int frame_index, double timestamp, const SE3& T_cw,
                                            std::shared_ptr<const FrameFeatures> features) {
  auto keyframe = std::make_unique<KeyFrame>();
  keyframe->id = next_keyframe_id_++;
  keyframe->frame_index = frame_index;
  keyframe->timestamp = timestamp;
  keyframe->T_cw = T_cw;
  keyframe->points.assign(static_cast<std::size_t>(features->size()), nullptr);
  keyframe->aligned.assign(static_cast<std::size_t>(features->size()), 0);
  keyframe->movable.assign(static_cast<std::size_t>(features->size()), 0);
  keyframe->features = std::move(features);
  return keyframe;
}

KeyFrame* Map::insert_keyframe(std::unique_ptr<KeyFrame> keyframe) {
  newest_submap_ = std::max(newest_submap_, keyframe->submap);
  keyframes_.push_back(std::move(keyframe));
  active_keyframes_.push_back(keyframes_.back().get());
  return active_keyframes_.back();
}

MapPoint* Map::add_point(const Eigen::Vector3d& position, KeyFrame* keyframe, int feature) {
  auto point = std::make_unique<MapPoint>();
  point->id = next_point_id_++;
  point->position = position;
  point->first_keyframe = keyframe->id;
  point->colour = keyframe->features->colour[static_cast<std::size_t>(feature)];
  points_.push_back(std::move(point));
  MapPoint* added = points_.back().get();
  add_observation(added, keyframe, feature, true);
  update_point(added);
  return added;
}

void Map::add_observation(MapPoint* point, KeyFrame* keyframe, int feature, bool aligned) {
  MapPoint*& slot = keyframe->points[static_cast<std::size_t>(feature)];
  if (slot != nullptr || observing_feature(*point, *keyframe) >= 0) return;
  slot = point;
  keyframe->aligned[static_cast<std::size_t>(feature)] = aligned;
  point->observations.insert(lower_bound(*point, *keyframe), {keyframe, feature});
  point->descriptor_is_current = false;
}

void Map::remove_observation(MapPoint* point, KeyFrame* keyframe) {
  const auto at = lower_bound(*point, *keyframe);
  if (at == point->observations.end() || at->keyframe != keyframe) return;
  keyframe->points[static_cast<std::size_t>(at->feature)] = nullptr;
  point->observations.erase(at);
  point->descriptor_is_current = false;
  const bool stereo =
      std::any_of(point->observations.begin(), point->observations.end(),
                  [](const Observation& o) { return o.keyframe->features->has_stereo(o.feature); });
  if (point->observations.empty() || (point->observations.size() < 2 && !stereo)) erase_point(point);
}

void Map::erase_point(MapPoint* point) {
  if (point->erased) return;
  point->erased = true;
  for (const Observation& o : point->observations) {
    o.keyframe->points[static_cast<std::size_t>(o.feature)] = nullptr;
  }
  point->observations.clear();
}

void Map::merge_points(MapPoint* from, MapPoint* into) {
  if (from == into || from->erased || into->erased) return;
  const std::vector<Observation> observations = from->observations;
  into->visible += from->visible;
  into->found += from->found;
  erase_point(from);
  from->replacement = into;
  for (const Observation& o : observations) add_observation(into, o.keyframe, o.feature);
  update_point(into);
}

void Map::erase_keyframe(KeyFrame* keyframe) {
  if (keyframe->erased || keyframe->id == 0 || active_keyframes_.size() < 2) return;
  // The closest neighbour stands in; without one, the keyframe before it.
  KeyFrame* stand_in = nullptr;
  if (!keyframe->covisibles.empty()) {
    stand_in = keyframe->covisibles.front().keyframe;
  } else {
    const auto at = std::find(active_keyframes_.begin(), active_keyframes_.end(), keyframe);
    stand_in = at != active_keyframes_.begin() ? *(at - 1) : *(at + 1);
  }
  for (MapPoint* point : std::vector<MapPoint*>(keyframe->points)) {
    if (point != nullptr) remove_observation(point, keyframe);
  }
  for (const Covisible& c : keyframe->covisibles) remove_edge(c.keyframe, keyframe);
  std::erase(active_keyframes_, keyframe);
  keyframe->erased = true;
  keyframe->stand_in = stand_in;
  keyframe->T_c_stand_in = keyframe->T_cw * stand_in->T_cw.inverse();
  keyframe->covisibles = {};
  keyframe->points = {};
  keyframe->aligned = {};
  keyframe->movable = {};
  keyframe->objects = {};
  keyframe->pixels.reset();
  keyframe->patches.reset();
  keyframe->features.reset();
}

void Map::update_point(MapPoint* point) const {
  if (point->erased || point->observations.empty()) return;
  if (!point->descriptor_is_current) point->descriptor = typical_descriptor(*point);
  point->descriptor_is_current = true;
  update_view(point);
}

void Map::update_view(MapPoint* point) const {
  if (point->erased || point->observations.empty()) return;
  point->normal.setZero();
  for (const Observation& o : point->observations) {
    point->normal += (point->position - camera_centre(o.keyframe->T_cw)).normalized();
  }
  point->normal.normalize();
  const Observation& first = point->observations.front();
  const double distance = (first.keyframe->T_cw * point->position).norm();
  const int level = first.keyframe->features->keypoint(first.feature).level;
  point->reference_distance = distance * scales_[static_cast<std::size_t>(level)];
}

void Map::update_covisibility(KeyFrame* keyframe) {
  thread_local KeyframeTable shared;  // for its memory
  shared.clear();
  for (const MapPoint* point : keyframe->points) {
    if (point == nullptr) continue;
    for (const Observation& o : point->observations) {
      if (o.keyframe != keyframe) ++shared[o.keyframe];
    }
  }
  shared.sort_by_value();  // an order that repeats
  const int most = shared.entries().empty() ? 0 : shared.entries().front().value;
  for (const Covisible& old : keyframe->covisibles) remove_edge(old.keyframe, keyframe);
  keyframe->covisibles.clear();
  for (const auto& [neighbour, count] : shared.entries()) {
    if (count < std::min(kFewestShared, most)) break;
    keyframe->covisibles.push_back({neighbour, count});
    const Covisible edge{keyframe, count};
    neighbour->covisibles.insert(
        std::upper_bound(neighbour->covisibles.begin(), neighbour->covisibles.end(), edge, comes_first),
        edge);
  }
}

void Map::collect_erased() {
  if (!readers_let_go_.exchange(false)) return;
  erased_points_.clear();
  std::size_t kept = 0;
  for (std::unique_ptr<MapPoint>& point : points_) {
    if (point->erased) {
      erased_points_.push_back(std::move(point));
    } else {
      // Where nothing was erased before it, a point stays where it is.
      if (&points_[kept] != &point) points_[kept] = std::move(point);
      ++kept;
    }
  }
  points_.resize(kept);
}

}  // namespace penumbra::slam
