#include "slam/backend/map_merger.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

namespace {

// Places in `maps`, in an order that says nothing of how they were given.
std::vector<std::size_t> own_order(const std::vector<std::unique_ptr<Map>>& maps) {
  std::vector<std::size_t> order(maps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t m) {
    const Map& map = *maps[m];
    const KeyFrame* first = map.keyframes().empty() ? nullptr : map.keyframes().front();
    const Eigen::Vector3d last =
        first == nullptr ? Eigen::Vector3d::Zero() : camera_centre(map.keyframes().back()->T_cw);
    return std::tuple(-static_cast<std::ptrdiff_t>(map.keyframes().size()),
                      -static_cast<std::ptrdiff_t>(map.points().size()),
                      first == nullptr ? 0.0 : first->timestamp, last.x(), last.y(), last.z());
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return order;
}

// Pixels: the mean of what the maps' own adjustments have found, by keyframes.
double disparity_offset_of(const std::vector<std::unique_ptr<Map>>& maps,
                           const std::vector<std::size_t>& order) {
  double sum = 0.0, keyframes = 0.0;
  for (const std::size_t m : order) {
    const auto weight = static_cast<double>(maps[m]->keyframes().size());
    sum += weight * maps[m]->camera().disparity_offset;
    keyframes += weight;
  }
  return keyframes > 0.0 ? sum / keyframes : 0.0;
}

void adjust(Map& map, int submap, const FullBundleSettings& settings) {
  FullBundleAdjustment adjustment(map, submap, settings);
  adjustment.solve();
  adjustment.apply(map);
}

// A map within the merged one.
struct Appended {
  std::size_t source = 0;
  std::vector<KeyFrame*> keyframes;
  SE3 first_T_cw;  // in its own world
  int ties = 0;
};

const KeyFrame& standing(const KeyFrame& keyframe) {
  const KeyFrame* k = &keyframe;
  while (k->erased) k = k->stand_in;
  return *k;
}

// Ties what the keyframes of one map show to the others.
class Tie {
 public:
  Tie(Map& map, const PlaceIndex& index, const LoopCloserSettings& settings)
      : map_(map), index_(index), settings_(settings), sightings_(settings, map.camera().baseline) {}

  // Ids of the map's keyframes: places there prove nothing new.
  void begin(int first_id, int end_id) {
    first_id_ = first_id;
    end_id_ = end_id;
    sightings_.clear();
    last_ = -1;
    way_ = 0.0;
    before_ = nullptr;
  }
  // Whether the map was corrected.
  bool add(KeyFrame* keyframe) {
    if (before_ != nullptr)
      way_ += (camera_centre(keyframe->T_cw) - camera_centre(current_pose(*before_))).norm();
    before_ = keyframe;
    sightings_.forget_before(*keyframe);
    const std::optional<VerifiedPlace> place = recognise(*keyframe);
    if (!place) return false;
    const PlaceSighting sighting{keyframe, place->T_cw};
    const bool pauses = last_ >= 0 && keyframe->id - last_ <= settings_.pause;
    if (pauses || !sightings_.agree_with(sighting)) {
      sightings_.add(sighting);
      return false;
    }
    correct_map(map_, keyframe, *place, edges_, settings_.correction);
    edges_.push_back({keyframe, place->keyframe, place->inliers});
    sightings_.clear();
    last_ = keyframe->id;
    way_ = 0.0;
    return true;
  }

 private:
  bool is_own(const KeyFrame& keyframe) const { return keyframe.id >= first_id_ && keyframe.id < end_id_; }
  static bool are_tied(const KeyFrame& a, const KeyFrame& b) {
    return std::any_of(a.covisibles.begin(), a.covisibles.end(),
                       [&](const Covisible& c) { return c.keyframe == &b; });
  }
  // What of the keyframes that are not excluded shows the same place, by appearance and geometry.
  std::vector<VerifiedPlace> verified(const KeyFrame& keyframe,
                                      const std::function<bool(const KeyFrame&)>& excluded) const {
    const Constellation objects = constellation_around(keyframe, settings_.verifier.constellation.neighbours);
    std::vector<VerifiedPlace> places;
    for (const PlaceCandidate& candidate : index_.query(keyframe.view(), settings_.candidates, excluded)) {
      std::optional<VerifiedPlace> place =
          verify_place(map_, keyframe.view(), candidate.keyframe, static_cast<std::uint64_t>(keyframe.id),
                       settings_.verifier, objects);
      if (place) places.push_back(std::move(*place));
    }
    return places;
  }
  bool are_one_place(const SE3& a, const SE3& b) const {
    return (camera_centre(a) - camera_centre(b)).norm() <= settings_.largest_distance;
  }
  // Equal houses along a street: a view that its own map shows elsewhere, too, proves nothing.
  bool is_ambiguous_at_home(const KeyFrame& keyframe) const {
    const auto excluded = [&](const KeyFrame& other) {
      return !is_own(other) || other.id == keyframe.id || are_tied(keyframe, other);
    };
    const std::vector<VerifiedPlace> places = verified(keyframe, excluded);
    return std::any_of(places.begin(), places.end(),
                       [&](const VerifiedPlace& place) { return !are_one_place(place.T_cw, keyframe.T_cw); });
  }
  std::optional<VerifiedPlace> recognise(const KeyFrame& keyframe) const {
    std::vector<VerifiedPlace> places =
        verified(keyframe, [&](const KeyFrame& other) { return is_own(other); });
    std::optional<VerifiedPlace> best;
    for (VerifiedPlace& place : places) {
      // Two places of one piece, and nothing to tell which it is.
      for (const VerifiedPlace& other : places) {
        if (other.keyframe->submap == place.keyframe->submap && !are_one_place(other.T_cw, place.T_cw))
          return {};
      }
      if (best && place.inliers <= best->inliers) continue;
      KeyFrame* const nearest =
          nearest_keyframe(place, settings_.largest_distance, settings_.largest_turn,
                           [&](const KeyFrame& k) { return !is_own(k) && !are_tied(keyframe, k); });
      if (nearest == nullptr || !drift_explains(keyframe, place)) continue;
      best = place;
      best->keyframe = nearest;
    }
    if (best && is_ambiguous_at_home(keyframe)) return {};
    return best;
  }
  // Between pieces nothing is known; within one no more than the way since the last tie can have added.
  bool drift_explains(const KeyFrame& keyframe, const VerifiedPlace& place) const {
    if (keyframe.submap != place.keyframe->submap) return true;
    return (camera_centre(keyframe.T_cw) - camera_centre(place.T_cw)).norm() <=
           settings_.drift_metres + settings_.drift_share * way_;
  }

  Map& map_;
  const PlaceIndex& index_;
  const LoopCloserSettings& settings_;
  PlaceSightings sightings_;
  std::vector<LoopEdge> edges_;
  int first_id_ = 0, end_id_ = 0;
  int last_ = -1;     // id of the keyframe of the last tie; -1: none yet
  double way_ = 0.0;  // metres since then
  const KeyFrame* before_ = nullptr;
};

}  // namespace

KeyFrame* append_map(Map& into, const Map& from) {
  int submaps = 0;
  for (const KeyFrame* keyframe : from.keyframes()) submaps = std::max(submaps, keyframe->submap + 1);
  int first_submap = 0;
  for (int s = 0; s < submaps; ++s) {
    const int number = into.keyframes().empty() && s == 0 ? 0 : into.begin_submap();
    if (s == 0) first_submap = number;
  }
  const int first_object = into.next_object_number();
  std::unordered_map<const KeyFrame*, KeyFrame*> copy_of;
  KeyFrame* first = nullptr;
  for (const KeyFrame* keyframe : from.keyframes()) {
    std::unique_ptr<KeyFrame> copy =
        into.new_keyframe(keyframe->frame_index, keyframe->timestamp, keyframe->T_cw, keyframe->features);
    copy->pixels = keyframe->pixels;
    copy->movable = keyframe->movable;
    copy->objects = keyframe->objects;
    for (SeenObject& object : copy->objects) object.number += first_object;
    copy->submap = first_submap + keyframe->submap;
    KeyFrame* const inserted = into.insert_keyframe(std::move(copy));
    copy_of[keyframe] = inserted;
    if (first == nullptr) first = inserted;
  }
  for (const auto& point : from.points()) {
    if (point->erased) continue;
    MapPoint* copy = nullptr;
    for (const Observation& o : point->observations) {
      KeyFrame* const keyframe = copy_of.at(o.keyframe);
      const auto feature = static_cast<std::size_t>(o.feature);
      if (copy == nullptr) {
        copy = into.add_point(point->position, keyframe, o.feature);
      } else {
        into.add_observation(copy, keyframe, o.feature);
      }
      keyframe->aligned[feature] = o.keyframe->aligned[feature];
    }
    if (copy == nullptr) continue;
    copy->patch = point->patch;
    copy->patch_depth = point->patch_depth;
    copy->visible = point->visible;
    copy->found = point->found;
    copy->colour = point->colour;
    into.update_point(copy);
  }
  for (const auto& [original, copy] : copy_of) into.update_covisibility(copy);
  return first;
}

MergedMaps merge_maps(const std::vector<std::unique_ptr<Map>>& maps, const MapMergerSettings& settings,
                      const std::function<void(int, int)>& progress) {
  MergedMaps merged;
  const std::vector<std::size_t> order = own_order(maps);
  const Map& largest = *maps[order.front()];
  merged.map = std::make_unique<Map>(largest.camera(), largest.scales());
  Map& map = *merged.map;
  map.set_disparity_offset(disparity_offset_of(maps, order));
  PlaceIndex index;
  std::vector<Appended> appended;
  int keyframes = 0;
  for (const std::size_t m : order) {
    Appended part;
    part.source = m;
    const std::size_t before = map.keyframes().size();
    append_map(map, *maps[m]);
    part.keyframes.assign(map.keyframes().begin() + static_cast<std::ptrdiff_t>(before),
                          map.keyframes().end());
    if (!part.keyframes.empty()) part.first_T_cw = part.keyframes.front()->T_cw;
    keyframes += static_cast<int>(part.keyframes.size());
    appended.push_back(std::move(part));
  }
  index.insert_all(map);

  Tie tie(map, index, settings.loops);
  std::set<int> grown;
  int looked_at = 0;
  for (Appended& part : appended) {
    if (part.keyframes.empty()) continue;
    tie.begin(part.keyframes.front()->id, part.keyframes.back()->id + 1);
    for (KeyFrame* keyframe : part.keyframes) {
      if (progress) progress(++looked_at, keyframes);
      if (keyframe->erased || !tie.add(keyframe)) continue;
      ++part.ties;
      grown.insert(keyframe->submap);
    }
  }
  for (const int submap : grown) {
    const bool is_there = std::any_of(map.keyframes().begin(), map.keyframes().end(),
                                      [&](const KeyFrame* keyframe) { return keyframe->submap == submap; });
    if (!is_there) continue;
    cull_redundant_keyframes(map, submap, close_depth(map.camera(), settings.points), settings.culling);
    adjust(map, submap, settings.adjustment);
  }
  map.collect_erased();
  merged.parts.resize(maps.size());
  std::set<int> pieces;
  for (const KeyFrame* keyframe : map.keyframes()) pieces.insert(keyframe->submap);
  merged.pieces = static_cast<int>(pieces.size());
  for (const Appended& part : appended) {
    MergedPart& told = merged.parts[part.source];
    told.source = part.source;
    told.keyframes = static_cast<int>(part.keyframes.size());
    told.ties = part.ties;
    if (part.keyframes.empty()) continue;
    told.piece = standing(*part.keyframes.front()).submap;
    told.T_merged_own = current_pose(*part.keyframes.front()).inverse() * part.first_T_cw;
  }
  return merged;
}

}  // namespace penumbra::slam
