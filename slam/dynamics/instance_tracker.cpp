#include "slam/dynamics/instance_tracker.h"

#include <algorithm>
#include <map>

#include "slam/dynamics/movable.h"

namespace penumbra::slam {

namespace {

constexpr double kFrameSeconds = 0.1;  // where the times do not say
// Evidence of one frame; the frames' displacements overlap, so one alone must not decide.
constexpr double kLeastEvidence = -1.0, kMostEvidence = 3.0;
constexpr double kLargestLogOdds = 6.0;
constexpr double kMoverLogOdds = 1.0;  // of what seems to move, without a mask, before its motion is measured
// How long a displacement must and may take, as a share of the longest look.
constexpr double kLeastLookShare = 0.15, kMostLookShare = 2.0;

double clamped(double value, double limit) { return std::clamp(value, -limit, limit); }

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

const InstanceTracker::FrameRecord* InstanceTracker::record(int frame) const {
  const auto at =
      std::find_if(history_.begin(), history_.end(), [&](const FrameRecord& r) { return r.index == frame; });
  return at == history_.end() ? nullptr : &*at;
}

double InstanceTracker::seconds_between(const FrameRecord& from, const FrameRecord& to) const {
  const double seconds = to.time - from.time;
  const int frames = to.index - from.index;
  return seconds * frames > 0.0 ? seconds : kFrameSeconds * frames;
}

bool InstanceTracker::moves(std::size_t object) const {
  return instances_[object].state() == MotionState::moving;
}

// Stronger than not moving: the map may rely on it.
bool InstanceTracker::stands(std::size_t object) const {
  const TrackedInstance& instance = instances_[object];
  return !instance.can_move || (instance.measured && instance.log_odds <= settings_.standing_log_odds);
}

PointOrigin InstanceTracker::origin_of(const FrameRecord& at, int feature) const {
  PointOrigin origin;
  const FrameFeatures& features = *at.features;
  if (!features.has_stereo(feature)) return origin;
  const Keypoint& k = features.keypoint(feature);
  const SE3 T_oc = at.T_co.inverse();
  const double scale = scales_[static_cast<std::size_t>(k.level)];
  origin.position = T_oc * camera_.back_project(k.u, k.v, features.depth[static_cast<std::size_t>(feature)]);
  origin.covariance = T_oc.rotation * stereo_covariance(camera_, features, feature, scale, settings_.motion) *
                      T_oc.rotation.transpose();
  origin.time = at.time;
  origin.known = true;
  return origin;
}

// Carries the object's newest view, which belongs to `from`, to `to`; false where it has left the image.
bool InstanceTracker::follow(std::size_t object, const FrameRecord& from, const FrameRecord& to,
                             const SE3& T_to_from) {
  Followed& followed = followed_[object];
  const InstanceView& view = followed.views.back();
  std::vector<Eigen::Vector3d> displacements = {Eigen::Vector3d::Zero()};
  if (moves(object)) {
    displacements[0] = from.T_co.rotation * instances_[object].velocity * seconds_between(from, to);
    // In a bend its velocity turns, and what drives ahead goes on as it did as the camera sees it.
    if (followed.views.size() >= 2) {
      const InstanceView& before = followed.views[followed.views.size() - 2];
      displacements.push_back(T_to_from.inverse() * (2.0 * view.centre - before.centre) - view.centre);
    }
  }
  std::optional<CarriedView> carried;
  for (const Eigen::Vector3d& displacement : displacements) {
    std::optional<CarriedView> guess = carry_view(camera_, view, *from.features, *to.features, to.index,
                                                  T_to_from, displacement, settings_.view);
    if (guess && (!carried || guess->matches.size() > carried->matches.size())) carried = std::move(guess);
  }
  if (!carried) {
    followed.active = false;
    return false;
  }
  followed.origins = carried_origins(view, followed.origins, *carried);
  followed.views.push_back(std::move(carried->view));
  if (static_cast<int>(followed.views.size()) > settings_.history) followed.views.pop_front();
  instances_[object].last_frame = to.index;
  return true;
}

// The newest view's frame `at` has its final pose.
void InstanceTracker::measure(std::size_t object, const FrameRecord& at, bool learn_from_it) {
  Followed& followed = followed_[object];
  const InstanceView& view = followed.views.back();
  // What was found without a mask is not found again while it is followed: its motion tells that it is there.
  const bool seen = learn_from_it && learn(instances_[object], followed.origins, view, at);
  if (seen && moves(object) && instances_[object].class_name.empty()) followed.carried = 0;
  for (std::size_t n = 0; n < view.features.size(); ++n) {
    PointOrigin& origin = followed.origins[n];
    if (!at.reliable || !origin.known || std::abs(at.time - origin.time) > settings_.longest_look)
      origin = origin_of(at, view.features[n]);
  }
}

bool InstanceTracker::learn(TrackedInstance& instance, const std::vector<PointOrigin>& origins,
                            const InstanceView& view, const FrameRecord& at) {
  if (!at.reliable) return false;
  std::vector<PointDisplacement> displacements;
  for (std::size_t n = 0; n < view.features.size(); ++n) {
    if (!origins[n].known) continue;
    const PointOrigin now = origin_of(at, view.features[n]);
    const double seconds = now.time - origins[n].time;
    const double watched = std::abs(seconds) / settings_.longest_look;
    if (!now.known || !(watched >= kLeastLookShare && watched <= kMostLookShare)) continue;
    displacements.push_back(
        {now.position - origins[n].position, now.covariance + origins[n].covariance, seconds});
  }
  const std::optional<ObjectVelocity> velocity = estimate_velocity(displacements, settings_.motion);
  if (!velocity) return false;
  instance.velocity = velocity->metres_per_second;
  if (!settings_.check_motion) return true;
  const double evidence =
      std::clamp(moving_evidence(*velocity, settings_.motion), kLeastEvidence, kMostEvidence);
  instance.log_odds = clamped(instance.log_odds + evidence, kLargestLogOdds);
  instance.measured = true;
  return true;
}

// What the frames before the one that shows a new object say about its motion.
void InstanceTracker::look_back(std::size_t object, const FrameRecord& at, const InstanceView& view) {
  InstanceView newer = view;
  std::vector<PointOrigin> origins;
  for (const int feature : view.features) origins.push_back(origin_of(at, feature));
  const FrameRecord* from = &at;
  for (int back = 1; back <= settings_.frames_back; ++back) {
    const FrameRecord* to = record(at.index - back);
    if (to == nullptr || !from->reliable) return;
    std::optional<CarriedView> older =
        carry_view(camera_, newer, *from->features, *to->features, to->index, to->T_co * from->T_co.inverse(),
                   Eigen::Vector3d::Zero(), settings_.view);
    if (!older) return;
    origins = carried_origins(newer, origins, *older);
    newer = std::move(older->view);
    from = to;
    learn(instances_[object], origins, newer, *to);
    mark(object, *to, newer);
  }
}

// Whether enough is left to locate a frame without these features: near ones, as the map has points of.
bool InstanceTracker::can_spare(const FrameFeatures& features, const std::vector<int>& spared) const {
  const auto counts = [&](int i) {
    return features.has_stereo(i) && !features.is_movable(i) &&
           features.depth[static_cast<std::size_t>(i)] <= settings_.close_depth;
  };
  int others = 0;
  for (int i = 0; i < features.size(); ++i) others += counts(i);
  for (const int i : spared) others -= counts(i);
  return others >= settings_.fewest_others;
}

void InstanceTracker::mark(std::size_t object, const FrameRecord& at, const InstanceView& view) {
  if (!moves(object)) return;
  const bool proven = instances_[object].measured;
  if (at.keyframe != nullptr) {
    // The map's: not ours to change, nor on suspicion.
    if (proven) moving_features_.push_back({at.keyframe, view.features});
    return;
  }
  // Where the way is lost nobody begins anew on something large that may drive away.
  const bool is_large = view.area() >= settings_.large_share * camera_.width * camera_.height;
  if (!proven && !(is_large && !trusted_) && !can_spare(*at.features, view.features)) return;
  for (const int i : view.features) at.features->movable[static_cast<std::size_t>(i)] = 1;
}

void InstanceTracker::carry(int frame, double time, const std::shared_ptr<FrameFeatures>& features,
                            const SE3& T_step) {
  FrameRecord now;
  now.index = frame;
  now.time = std::isfinite(time) ? time : kFrameSeconds * frame;
  now.features = features;
  if (!history_.empty()) now.T_co = T_step * history_.back().T_co;
  history_.push_back(std::move(now));
  if (static_cast<int>(history_.size()) > settings_.history) history_.pop_front();
  if (history_.size() < 2) return;
  const FrameRecord& last = history_[history_.size() - 2];
  for (std::size_t object = 0; object < followed_.size(); ++object) {
    Followed& followed = followed_[object];
    if (!followed.active) {
      // Out of sight for so long that no result can be about it any more.
      if (!followed.views.empty() && followed.views.back().frame < history_.front().index)
        followed.views.clear();
      continue;
    }
    if (++followed.carried > settings_.most_carried) {
      followed.active = false;
      continue;
    }
    follow(object, last, history_.back(), T_step);
  }
  // What is known to move first: what is only taken to must leave enough besides.
  for (const bool proven : {true, false}) {
    for (std::size_t object = 0; object < followed_.size(); ++object) {
      if (followed_[object].active && instances_[object].measured == proven)
        mark(object, history_.back(), followed_[object].views.back());
    }
  }
}

void InstanceTracker::observe(const SE3& T_step, bool reliable) {
  FrameRecord& now = history_.back();
  now.reliable = trusted_ = reliable;
  now.observed = true;
  if (history_.size() >= 2) now.T_co = T_step * history_[history_.size() - 2].T_co;
  for (std::size_t object = 0; object < followed_.size(); ++object) {
    if (!followed_[object].active) continue;
    const bool moved_before = moves(object);
    measure(object, now, /*learn_from_it=*/true);
    if (moved_before || !moves(object)) continue;
    for (const InstanceView& view : followed_[object].views) {
      if (const FrameRecord* at = record(view.frame)) mark(object, *at, view);
    }
  }
  if (!settings_.companions.enabled) return;
  std::vector<PointOrigin> origins;
  for (int i = 0; i < now.features->size(); ++i) origins.push_back(origin_of(now, i));
  if (const std::optional<Instance> companion =
          companions_.observe(now.features, std::move(origins), now.T_co, now.time, reliable))
    add_mover(now.index, *companion);
}

// The object that an instance shows; -1 for none that is known.
int InstanceTracker::owner_of(const Instance& instance, const InstanceView& view,
                              const std::vector<char>& taken) const {
  int best = -1;
  double best_score = 0.0;
  for (std::size_t object = 0; object < followed_.size(); ++object) {
    if (taken[object] != 0) continue;
    const TrackedInstance& known = instances_[object];
    const Followed& followed = followed_[object];
    const auto at = std::find_if(followed.views.begin(), followed.views.end(),
                                 [&](const InstanceView& v) { return v.frame == view.frame; });
    double score = 0.0;
    const bool same_class = known.class_name == instance.class_name || known.class_name.empty();
    if (at != followed.views.end()) {
      const double shared = overlap(*at, view);
      const double apart = (at->centre - view.centre).norm();
      if (shared >= settings_.least_overlap) {
        score = 1.0 + shared;
      } else if (same_class && containment(*at, view) >= settings_.least_containment) {
        score = 0.5 + shared;
      } else if (same_class && apart < settings_.nearest_metres + 0.05 * view.centre.z()) {
        score = 0.5 / (1.0 + apart);
      }
    } else if (same_class && !followed.views.empty() && known.state() != MotionState::moving) {
      // Out of sight, behind something, or not found for a while: where it stood when it was last seen.
      const FrameRecord* then = record(followed.views.back().frame);
      const FrameRecord* now = record(view.frame);
      if (then == nullptr || now == nullptr) continue;
      const double apart =
          (now->T_co * (then->T_co.inverse() * followed.views.back().centre) - view.centre).norm();
      if (apart < settings_.nearest_metres + 0.05 * view.centre.z()) score = 0.5 / (1.0 + apart);
    }
    if (score > 0.0 && same_class) score += 0.5;
    if (score > best_score) {
      best_score = score;
      best = static_cast<int>(object);
    }
  }
  return best;
}

// Starts to follow the object anew from `view`, up to the newest frame.
void InstanceTracker::place(std::size_t object, const InstanceView& view, bool is_new) {
  Followed& followed = followed_[object];
  TrackedInstance& instance = instances_[object];
  const double depth = view.centre.z(), area = view.area() * depth * depth;
  if (!view.touches_border({camera_.width, camera_.height}) || is_new)
    followed.reference_area = std::max(followed.reference_area, area);
  if (followed.reference_area > 0.0) instance.visible_share = std::min(1.0, area / followed.reference_area);
  instance.size = {view.region.width * depth / camera_.fx, view.region.height * depth / camera_.fy,
                   view.farthest - view.nearest};
  std::vector<PointOrigin> origins(view.features.size());
  if (!followed.views.empty() && followed.views.back().frame == view.frame) {
    // Found again where it was expected: its points keep their past.
    const std::vector<int>& expected = followed.views.back().features;
    for (std::size_t n = 0; n < expected.size() && n < followed.origins.size(); ++n) {
      const auto same = std::lower_bound(view.features.begin(), view.features.end(), expected[n]);
      if (same != view.features.end() && *same == expected[n])
        origins[static_cast<std::size_t>(same - view.features.begin())] = followed.origins[n];
    }
  }
  while (!followed.views.empty() && followed.views.back().frame >= view.frame) followed.views.pop_back();
  followed.views.push_back(view);
  followed.active = true;
  followed.carried = followed.missed = 0;
  auto at = std::find_if(history_.begin(), history_.end(),
                         [&](const FrameRecord& r) { return r.index == view.frame; });
  if (is_new) look_back(object, *at, view);
  followed.origins = std::move(origins);
  mark(object, *at, view);
  if (at->observed) measure(object, *at, false);
  for (auto next = at + 1; next != history_.end(); at = next++) {
    ++followed.carried;
    if (!follow(object, *at, *next, next->T_co * at->T_co.inverse())) return;
    if (next->observed) measure(object, *next, is_new);
    mark(object, *next, followed.views.back());
  }
}

// Gives what was found to the object that it shows, or makes a new one of it.
std::size_t InstanceTracker::add(const FrameRecord& at, const Instance& found, const InstanceView& view,
                                 bool moves, std::vector<char>& taken) {
  const int owner = owner_of(found, view, taken);
  const std::size_t object = owner >= 0 ? static_cast<std::size_t>(owner) : instances_.size();
  if (owner < 0) {
    TrackedInstance instance;
    instance.id = static_cast<int>(object);
    instance.first_frame = at.index;
    instance.log_odds = moving_prior(found.class_name);
    instance.measured = !settings_.check_motion;
    instances_.push_back(std::move(instance));
    followed_.emplace_back();
    taken.push_back(0);
  }
  taken[object] = 1;
  TrackedInstance& instance = instances_[object];
  if (moves) {
    instance.log_odds = std::max(instance.log_odds, kMoverLogOdds);
    instance.can_move = true;
  } else if (found.score >= instance.score) {
    instance.class_name = found.class_name;
    instance.can_move = is_movable_class(found.class_name);
    instance.score = found.score;
  }
  instance.last_frame = std::max(instance.last_frame, at.index);
  ++instance.detections;
  place(object, view, owner < 0);
  return object;
}

void InstanceTracker::add(int frame, const std::vector<Instance>& instances) {
  const FrameRecord* at = record(frame);
  if (at == nullptr) return;
  std::vector<char> taken(followed_.size(), 0);
  std::vector<const Instance*> order;
  for (const Instance& found : instances) {
    if (found.score >= settings_.least_score) order.push_back(&found);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Instance* a, const Instance* b) { return a->score > b->score; });
  for (const Instance* found : order) {
    const std::optional<InstanceView> view = make_view(camera_, frame, *found, *at->features, settings_.view);
    if (view) add(*at, *found, *view, false, taken);
  }
  for (std::size_t object = 0; object < taken.size(); ++object) {
    Followed& followed = followed_[object];
    if (taken[object] != 0 || !followed.active || instances_[object].class_name.empty()) continue;
    if (++followed.missed >= settings_.most_missed) followed.active = false;
  }
}

void InstanceTracker::add_mover(int frame, const Instance& mover) {
  const FrameRecord* at = record(frame);
  if (at == nullptr) return;
  const std::optional<InstanceView> view = make_view(camera_, frame, mover, *at->features, settings_.view);
  std::vector<char> taken(followed_.size(), 0);
  if (view) add(*at, mover, *view, true, taken);
}

std::vector<MovingFeatures> InstanceTracker::take_moving_features() {
  return std::exchange(moving_features_, {});
}

std::vector<KeyframeObjects> InstanceTracker::take_keyframe_objects() {
  std::map<int, std::vector<SeenObject>> seen;  // by frame
  for (const FrameRecord& record : history_) {
    if (record.keyframe != nullptr) seen[record.index];
  }
  for (std::size_t object = 0; object < followed_.size(); ++object) {
    for (const InstanceView& view : followed_[object].views) {
      const auto at = seen.find(view.frame);
      if (at == seen.end()) continue;
      at->second.push_back(seen_object(object, view));
    }
  }
  std::vector<KeyframeObjects> changed;
  for (FrameRecord& record : history_) {
    if (record.keyframe == nullptr || record.told == seen[record.index]) continue;
    record.told = seen[record.index];
    changed.push_back({record.keyframe, record.told});
  }
  return changed;
}

SeenObject InstanceTracker::seen_object(std::size_t object, const InstanceView& view) const {
  return {first_number_ + static_cast<int>(object), instances_[object].class_name, view.centre, view.region,
          stands(object)};
}

// Calls visit(object, view) for what `frame` shows.
template <typename Visit>
void InstanceTracker::visit_views(int frame, Visit&& visit) const {
  for (std::size_t object = 0; object < followed_.size(); ++object) {
    for (const InstanceView& view : followed_[object].views) {
      if (view.frame == frame) visit(object, view);
    }
  }
}

std::vector<SeenObject> InstanceTracker::objects() const {
  std::vector<SeenObject> objects;
  if (history_.empty()) return objects;
  visit_views(history_.back().index, [&](std::size_t object, const InstanceView& view) {
    objects.push_back(seen_object(object, view));
  });
  return objects;
}

double InstanceTracker::covered_share() const {
  ByteImage covered;
  for (std::size_t object = 0; object < followed_.size(); ++object) {
    if (!followed_[object].active || !moves(object) || (trusted_ && !instances_[object].measured)) continue;
    if (covered.empty()) covered = ByteImage::filled(camera_.width, camera_.height, 0);
    const InstanceView& view = followed_[object].views.back();
    for (int y = 0; y < view.region.height; ++y) {
      const std::uint8_t* mask = view.mask.row(y);
      std::uint8_t* row = covered.row(view.region.y + y) + view.region.x;
      for (int x = 0; x < view.region.width; ++x) row[x] |= mask[x];
    }
  }
  return covered.empty() ? 0.0 : count_pixels(covered) / static_cast<double>(covered.elements());
}

std::vector<InstanceSighting> InstanceTracker::sightings() const {
  return history_.empty() ? std::vector<InstanceSighting>{} : sightings(history_.back().index);
}

std::vector<InstanceSighting> InstanceTracker::sightings(int frame) const {
  std::vector<InstanceSighting> seen;
  visit_views(frame, [&](std::size_t object, const InstanceView& view) {
    seen.push_back({static_cast<int>(object), view.region, view.mask, view.centre, instances_[object].state(),
                    instances_[object].visible_share});
  });
  return seen;
}

}  // namespace penumbra::slam
