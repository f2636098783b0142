#include "slam/dynamics/instance_tracker.h"

#include <algorithm>

#include "slam/dynamics/instance_association.h"
#include "slam/dynamics/track_report.h"

namespace penumbra::slam {

namespace {

std::size_t place_of(const InstanceView& view, int feature) {
  const auto at = std::lower_bound(view.features.begin(), view.features.end(), feature);
  return static_cast<std::size_t>(at - view.features.begin());
}

// The origins of a view's features, for those that were found again where it was carried to.
std::vector<PointOrigin> carried_origins(const InstanceView& view, const std::vector<PointOrigin>& origins,
                                         const CarriedView& carried) {
  std::vector<PointOrigin> now(carried.view.features.size());
  for (const auto& [i, j] : carried.matches) now[place_of(carried.view, j)] = origins[place_of(view, i)];
  return now;
}

}  // namespace

bool InstanceTracker::is_keyframe(int frame) const {
  const FrameRecord* at = history_.find(frame);
  return at != nullptr && at->keyframe != nullptr;
}

const std::vector<char>* InstanceTracker::movable(int frame) const {
  const FrameRecord* at = history_.find(frame);
  return at == nullptr || at->keyframe != nullptr ? nullptr : &at->movable;
}

// Carries the track's newest view, which belongs to `from`, to `to`; false where it has left the image.
bool InstanceTracker::follow(Track& track, const FrameRecord& from, const FrameRecord& to,
                             const SE3& T_to_from) {
  const InstanceView& view = track.views.back();
  std::vector<Eigen::Vector3d> displacements = {Eigen::Vector3d::Zero()};
  if (track.moves()) {
    displacements[0] = from.T_co.rotation * track.instance.velocity * seconds_between(from, to);
    // In a bend its velocity turns, and what drives ahead goes on as it did as the camera sees it.
    if (track.views.size() >= 2) {
      const InstanceView& before = track.views[track.views.size() - 2];
      displacements.push_back(T_to_from.inverse() * (2.0 * view.centre - before.centre) - view.centre);
    }
  }
  std::optional<CarriedView> carried;
  for (const Eigen::Vector3d& displacement : displacements) {
    std::optional<CarriedView> guess =
        carry_view(camera_, view, from.view(), to.view(), to.index, T_to_from, displacement, settings_.view);
    if (guess && (!carried || guess->matches.size() > carried->matches.size())) carried = std::move(guess);
  }
  if (!carried) {
    track.active = false;
    return false;
  }
  track.origins = carried_origins(view, track.origins, *carried);
  track.views.push_back(std::move(carried->view));
  if (static_cast<int>(track.views.size()) > settings_.history) track.views.pop_front();
  track.instance.last_frame = to.index;
  return true;
}

// What the frames before the one that shows a new object say about its motion.
void InstanceTracker::look_back(Track& track, const FrameRecord& at, const InstanceView& view) {
  InstanceView newer = view;
  std::vector<PointOrigin> origins = belief_.origins_of(view, at);
  const FrameRecord* from = &at;
  for (int back = 1; back <= settings_.frames_back; ++back) {
    FrameRecord* to = history_.find(at.index - back);
    if (to == nullptr || !from->reliable) return;
    std::optional<CarriedView> older =
        carry_view(camera_, newer, from->view(), to->view(), to->index, to->T_co * from->T_co.inverse(),
                   Eigen::Vector3d::Zero(), settings_.view);
    if (!older) return;
    origins = carried_origins(newer, origins, *older);
    newer = std::move(older->view);
    from = to;
    belief_.learn(track.instance, origins, newer, *to);
    mark(track, *to, newer);
  }
}

// Whether enough is left to locate a frame without these features: near ones, as the map has points of.
bool InstanceTracker::can_spare(const FeatureView& features, const std::vector<int>& spared) const {
  const auto counts = [&](int i) {
    return features.has_stereo(i) && !features.is_movable(i) && features.depth(i) <= settings_.close_depth;
  };
  int others = 0;
  for (int i = 0; i < features.size(); ++i) others += counts(i);
  for (const int i : spared) others -= counts(i);
  return others >= settings_.fewest_others;
}

void InstanceTracker::mark(const Track& track, FrameRecord& at, const InstanceView& view) {
  if (!track.moves()) return;
  if (at.keyframe != nullptr) {
    // The map's: not ours to change on suspicion, nor on what is known of another.
    if (!track.is_known_to_move()) return;
    moving_features_.push_back({at.keyframe, view.features});
    std::erase_if(moving_features_.back().features, [&](int i) { return at.stands(i); });
    return;
  }
  // Where the way is lost nobody begins anew on something large that may drive away.
  const bool is_large = view.area() >= settings_.large_share * camera_.width * camera_.height;
  if (!track.instance.measured && !(is_large && !trusted_) && !can_spare(at.view(), view.features)) return;
  for (const int i : view.features) {
    if (!at.stands(i)) at.movable[static_cast<std::size_t>(i)] = 1;
  }
}

// Objects that are out of sight for so long that no result can be about them any more.
void InstanceTracker::forget_gone() {
  std::erase_if(tracks_, [&](Track& track) {
    if (track.active || track.views.back().frame >= history_.oldest().index) return false;
    gone_.push_back(std::move(track.instance));
    return true;
  });
}

void InstanceTracker::before_pose(const FrameBeforePose& frame, std::vector<char>& movable) {
  history_.begin(frame.index, frame.time, frame.features, frame.T_step);
  if (history_.size() >= 2) {
    forget_gone();
    for (Track& track : tracks_) {
      if (!track.active) continue;
      if (++track.carried > settings_.most_carried) {
        track.active = false;
        continue;
      }
      follow(track, history_.before_newest(), history_.newest(), frame.T_step);
    }
    // What is known to move first: what is only taken to must leave enough besides.
    for (const bool proven : {true, false}) {
      for (const Track& track : tracks_) {
        if (track.active && track.instance.measured == proven)
          mark(track, history_.newest(), track.views.back());
      }
    }
  }
  movable = history_.newest().movable;
}

std::vector<Instance> InstanceTracker::after_pose(const FrameAfterPose& frame, std::vector<char>& movable) {
  history_.locate(frame.T_step, frame.reliable, frame.pixels, movable);
  trusted_ = frame.reliable;
  for (Track& track : tracks_) {
    if (!track.active) continue;
    const bool moved_before = track.moves();
    belief_.measure(track, history_.newest(), /*learns=*/true);
    if (moved_before || !track.moves()) continue;
    for (const InstanceView& view : track.views) {
      if (FrameRecord* at = history_.find(view.frame)) mark(track, *at, view);
    }
  }
  movable = history_.newest().movable;
  return {};
}

// Starts to follow the object anew from `view`, up to the newest frame.
void InstanceTracker::place(Track& track, const InstanceView& view, bool is_new) {
  TrackedInstance& instance = track.instance;
  const double depth = view.centre.z(), area = view.area() * depth * depth;
  if (!view.touches_border({camera_.width, camera_.height}) || is_new)
    track.reference_area = std::max(track.reference_area, area);
  if (track.reference_area > 0.0) instance.visible_share = std::min(1.0, area / track.reference_area);
  instance.size = {view.region.width * depth / camera_.fx, view.region.height * depth / camera_.fy,
                   view.farthest - view.nearest};
  std::vector<PointOrigin> origins(view.features.size());
  if (!track.views.empty() && track.views.back().frame == view.frame) {
    // Found again where it was expected: its points keep their past.
    const std::vector<int>& expected = track.views.back().features;
    for (std::size_t n = 0; n < expected.size() && n < track.origins.size(); ++n) {
      const auto same = std::lower_bound(view.features.begin(), view.features.end(), expected[n]);
      if (same != view.features.end() && *same == expected[n])
        origins[static_cast<std::size_t>(same - view.features.begin())] = track.origins[n];
    }
  }
  while (!track.views.empty() && track.views.back().frame >= view.frame) track.views.pop_back();
  track.views.push_back(view);
  track.active = true;
  track.carried = track.missed = 0;
  auto& records = history_.records();
  auto at = std::find_if(records.begin(), records.end(),
                         [&](const FrameRecord& r) { return r.index == view.frame; });
  if (is_new) look_back(track, *at, view);
  track.origins = std::move(origins);
  mark(track, *at, view);
  if (at->observed) belief_.measure(track, *at, /*learns=*/false);
  for (auto next = at + 1; next != records.end(); at = next++) {
    ++track.carried;
    if (!follow(track, *at, *next, next->T_co * at->T_co.inverse())) return;
    if (next->observed) belief_.measure(track, *next, is_new);
    mark(track, *next, track.views.back());
  }
}

// Gives what was found to the object that it shows, or makes a new one of it.
void InstanceTracker::add(const FrameRecord& at, const Instance& found, const InstanceView& view, bool moves,
                          std::vector<char>& taken) {
  const int owner = owner_of(found, view, tracks_, taken, history_, settings_);
  const bool shows_mover = owner >= 0 && tracks_[static_cast<std::size_t>(owner)].is_known_to_move();
  if (!moves && found.score < settings_.least_score && !shows_mover) return;
  const std::size_t place_in_list = owner >= 0 ? static_cast<std::size_t>(owner) : tracks_.size();
  if (owner < 0) {
    TrackedInstance known = belief_.prior(found.class_name);
    if (const Track* whole = whole_of(found, view, tracks_, settings_))
      belief_.take_over(known, whole->instance);
    known.id = next_id_++;
    known.first_frame = at.index;
    tracks_.emplace_back().instance = std::move(known);
    taken.push_back(0);
  }
  taken[place_in_list] = 1;
  TrackedInstance& instance = tracks_[place_in_list].instance;
  if (moves) {
    belief_.presume_moving(instance);
  } else if (found.score >= instance.score) {
    belief_.rename(instance, found.class_name);
    instance.score = found.score;
  }
  if (found.moves) belief_.hear(instance, *found.moves);
  instance.last_frame = std::max(instance.last_frame, at.index);
  ++instance.detections;
  place(tracks_[place_in_list], view, owner < 0);
}

void InstanceTracker::add(int frame, const std::vector<Instance>& instances) {
  segmented_ = true;
  const FrameRecord* at = history_.find(frame);
  if (at == nullptr) return;
  std::vector<char> taken(tracks_.size(), 0);
  std::vector<const Instance*> order;
  for (const Instance& found : instances) {
    if (found.score >= settings_.known_score_share * settings_.least_score) order.push_back(&found);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Instance* a, const Instance* b) { return a->score > b->score; });
  for (const Instance* found : order) {
    const std::optional<InstanceView> view = make_view(camera_, frame, *found, at->view(), settings_.view);
    if (view) add(*at, *found, *view, false, taken);
  }
  for (std::size_t t = 0; t < taken.size(); ++t) {
    Track& track = tracks_[t];
    if (taken[t] != 0 || !track.active || track.instance.class_name.empty()) continue;
    if (++track.missed >= settings_.most_missed) track.active = false;
  }
}

void InstanceTracker::add_mover(int frame, const Instance& mover) {
  const FrameRecord* at = history_.find(frame);
  if (at == nullptr) return;
  const std::optional<InstanceView> view = make_view(camera_, frame, mover, at->view(), settings_.view);
  std::vector<char> taken(tracks_.size(), 0);
  if (view) add(*at, mover, *view, true, taken);
}

MapEdits InstanceTracker::take_edits() {
  MapEdits edits;
  edits.moving = std::exchange(moving_features_, {});
  if (std::exchange(segmented_, false)) edits.objects = take_keyframe_objects();
  return edits;
}

std::vector<KeyframeObjects> InstanceTracker::take_keyframe_objects() {
  return tell_keyframe_objects(history_, tracks_, belief_, first_number_);
}

std::vector<SeenObject> InstanceTracker::objects() const {
  if (history_.empty()) return {};
  return seen_objects(tracks_, history_.newest().index, belief_, first_number_);
}

std::vector<TrackedInstance> InstanceTracker::instances() const {
  std::vector<TrackedInstance> instances;
  for (const Track& track : tracks_) instances.push_back(track.instance);
  return instances;
}

double InstanceTracker::covered_share() const {
  return moving_share(tracks_, camera_.width, camera_.height, /*proven=*/trusted_);
}

std::vector<InstanceSighting> InstanceTracker::sightings() const {
  return history_.empty() ? std::vector<InstanceSighting>{} : sightings(history_.newest().index);
}

std::vector<InstanceSighting> InstanceTracker::sightings(int frame) const {
  return sightings_in(tracks_, frame);
}

}  // namespace penumbra::slam
