#include "slam/brain/brain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "nn/base/error.h"
#include "nn/image/grey.h"
#include "slam/brain/loaded_map.h"

namespace penumbra::slam::brain {

namespace {

constexpr double kFirstSceneDistance = 15.0;  // metres, until the first keyframe has been measured

PlanePose pose_of(const PositionModel& model) {
  return {model.position().x(), model.position().y(), model.heading()};
}

// Few of the pyramid's levels: places are seen again from about as far.
OrbSettings few_features(int features) {
  OrbSettings settings;
  settings.features = features;
  settings.pyramid.levels = 4;
  return settings;
}

}  // namespace

Brain::Brain(const StereoCamera& camera, Sensor sensor, const BrainSettings& settings, LandmarkFinder finder,
             const StoredMap* loaded)
    : camera_(camera),
      settings_(settings),
      finder_(std::move(finder)),
      measurer_(sensor, few_features(settings.geometry.features), settings.threads),
      scales_(level_scales(few_features(0).pyramid)),
      sharpness_(settings.least_sharpness),
      position_(standard_grid_code()),
      memory_(settings.templates, settings.similarity, settings.profile),
      calibration_(settings.calibration_metres, settings.calibration_seconds) {
  settings_.check();
  if (settings.templates == TemplateKind::landmarks && settings.recall && !finder_)
    throw UsageError("templates of landmarks need a network that finds them");
  if (loaded == nullptr) return;
  require_fitting(*loaded, camera, settings, "cognitive map");
  map_ = loaded->map;
  for (const Template& view : loaded->views) memory_.add(view);
  loaded_nodes_ = map_.size();
  way_of_.assign(static_cast<std::size_t>(loaded_nodes_), -std::numeric_limits<double>::infinity());
  scene_distance_ = loaded->scene_distance;
  located_ = loaded_nodes_ == 0;
}

StoredMap Brain::stored() const {
  StoredMap stored{
      camera_, settings_.mount.yaw(), settings_.mount.pitch(), settings_.templates, scene_distance_, map_,
      {}};
  for (int i = 0; i < map_.size(); ++i) stored.views.push_back(memory_.at(i));
  return stored;
}

double Brain::keyframe_distance() const {
  if (settings_.keyframe_metres > 0.0) return settings_.keyframe_metres;
  return settings_.keyframe_share * (scene_distance_ > 0.0 ? scene_distance_ : kFirstSceneDistance);
}

double Brain::drift() const {
  if (!located_) return std::numeric_limits<double>::infinity();
  return settings_.drift_metres * keyframe_distance() + doubt_;
}

bool Brain::is_keyframe_due() const {
  return anchor_ < 0 || since_keyframe_.distance() >= keyframe_distance() ||
         std::abs(since_keyframe_.heading) >= settings_.keyframe_turn;
}

Brain::Look Brain::look_at(const StereoImages& images, const PlanePose& since_anchor) {
  Look look;
  look.frame = images.index;
  look.timestamp = images.timestamp;
  look.since_anchor = since_anchor;
  if (!settings_.recall) return look;
  if (settings_.templates == TemplateKind::intensity) {
    const auto scope = timer_.measure("template");
    look.view.profile = intensity_profile(to_grey(images.left).view(), settings_.profile);
  } else {
    const auto scope = timer_.measure("landmarks");
    finder_(images, look.view.landmarks);
  }
  if (settings_.proof == PlaceProof::geometry) {
    look.features = measurer_.measure(images, camera_, 1.0, timer_);
    look.points = place_points(camera_, *look.features, settings_.geometry);
    const double distance = median_distance(look.points);
    constexpr double kMemory = 0.9;
    if (distance > 0.0)
      scene_distance_ =
          scene_distance_ > 0.0 ? kMemory * scene_distance_ + (1.0 - kMemory) * distance : distance;
  }
  return look;
}

bool Brain::is_linked(int node, int other) const {
  const std::vector<int>& links = map_.links_of(node);
  return std::any_of(links.begin(), links.end(), [&](int l) {
    const Link& link = map_.links()[static_cast<std::size_t>(l)];
    return link.from == other || link.to == other;
  });
}

// All that this run has made is moved to where it must be for the robot, which is `here`, to be `there`.
void Brain::join_loaded_map(const PlanePose& here, const PlanePose& there) {
  const PlanePose moved = there * here.inverse();
  for (int i = loaded_nodes_; i < map_.size(); ++i) map_.node(i).pose = moved * map_.node(i).pose;
  located_ = true;
}

void Brain::make_node(Look look) {
  Node node;
  node.frame = look.frame;
  node.timestamp = look.timestamp;
  node.pose = anchor_ < 0 ? PlanePose{} : believed(look.since_anchor);
  const std::span<const float> activity = position_.activity_at({node.pose.x, node.pose.y});
  node.activity.assign(activity.begin(), activity.end());
  node.points = std::move(look.points);
  node.strength = settings_.phi;
  const int number = map_.add(std::move(node));
  memory_.add(look.view);
  way_of_.push_back(way_);
  if (anchor_ >= 0) {
    map_.add(Link{.from = anchor_,
                  .to = number,
                  .motion = look.since_anchor,
                  .recalled = false,
                  .metres = look.by_sight ? settings_.proven_sigma
                                          : settings_.least_way_sigma +
                                                settings_.way_sigma * look.since_anchor.distance(),
                  .radians = look.by_sight ? settings_.proven_turn_sigma
                                           : settings_.least_turn_sigma +
                                                 settings_.turn_sigma * std::abs(look.since_anchor.heading)});
    since_anchor_ = look.since_anchor.inverse() * since_anchor_;
  }
  anchor_ = number;
}

// The way from the last keyframe by sight, where geometry proves it and it is about what was felt.
void Brain::see_step(Look& look) {
  if (!(settings_.sight || settings_.calibration) || look.features == nullptr || last_points_.empty()) return;
  const auto scope = timer_.measure("step");
  const std::optional<ProvenPlace> seen = prove(look, last_points_);
  if (!seen) return;
  odometry_check_.add(look.felt, seen->motion);
  const PlanePose step = keyframe_.inverse() * look.since_anchor;
  const PlanePose off = step.inverse() * seen->motion;
  constexpr double kMostOff = 0.7;  // of a slip: share of the way
  if (off.distance() > 0.5 * keyframe_distance() + kMostOff * step.distance() ||
      std::abs(off.heading) > settings_.keyframe_turn)
    return;
  if (settings_.calibration) calibration_.learn(look.felt, seen->motion, look.seconds_felt);
  if (!settings_.sight) return;
  doubt_ = std::max(0.0, doubt_ - (settings_.drift_share - settings_.seen_drift_share) * step.distance());
  const PlanePose seen_since_anchor = keyframe_ * seen->motion;
  since_anchor_ = seen_since_anchor * (look.since_anchor.inverse() * since_anchor_);
  look.since_anchor = seen_since_anchor;
  look.by_sight = true;
  pull_position();
}

void Brain::pull_position() {
  const PlanePose pose = believed(since_anchor_);
  position_.reset({pose.x, pose.y}, pose.heading);
}

// (19, 20): G, how far and how much turned the robot is from its anchor, or a view that is not the anchor's.
bool Brain::has_moved_on(const Look& look) {
  if (look.since_anchor.distance() > settings_.new_node_distance * keyframe_distance() ||
      std::abs(look.since_anchor.heading) > settings_.new_node_distance * settings_.keyframe_turn)
    return true;
  return settings_.recall && memory_.likeness(anchor_, look.view) < settings_.least_similarity;
}

double Brain::settle() {
  const auto scope = timer_.measure("relax");
  const RelaxationSummary summary = relax(map_, settings_.relaxation);
  flown_apart_ += summary.flew_apart;
  return summary.largest_move;
}

void Brain::feel(std::span<const SelfMotion> motions) {
  last_felt_ = felt_;
  last_seconds_felt_ = seconds_felt_;
  for (const SelfMotion& felt : motions) {
    const SelfMotion motion = settings_.calibration ? calibration_.corrected(felt) : felt;
    felt_ = felt_ * step_of(felt);
    seconds_felt_ += felt.seconds;
    position_.move(motion.speed, motion.turn_rate, motion.seconds);
    since_keyframe_ = since_keyframe_ * step_of(motion);
    const double way = std::abs(motion.speed) * motion.seconds;
    way_ += way;
    doubt_ += settings_.drift_share * way;
  }
  if (anchor_ >= 0) since_anchor_ = map_.node(anchor_).pose.inverse() * pose_of(position_);
}

// Whether the frame before should take the image's place (12).
bool Brain::is_blurred(const StereoImages& images) {
  if (settings_.least_sharpness <= 0.0 || !settings_.recall) return false;
  const auto scope = timer_.measure("sharpness");
  const ByteImage grey = to_grey(images.left);
  if (sharpness_.is_sharp(grey.view())) return false;
  return !last_.left.empty() && last_.index != keyframe_frame_ &&
         tenengrad(to_grey(last_.left).view()) > tenengrad(grey.view());
}

void Brain::take_keyframe(const StereoImages& images, BrainResult& result) {
  result.keyframe = true;
  result.blurred = is_blurred(images);
  const PlanePose since_anchor = result.blurred ? last_since_anchor_ : since_anchor_;
  Look look = look_at(result.blurred ? last_ : images, since_anchor);
  look.felt = result.blurred ? last_felt_ : felt_;
  look.seconds_felt = result.blurred ? last_seconds_felt_ : seconds_felt_;
  // What has been driven since the keyframe's image.
  const PlanePose since_look = since_anchor.inverse() * since_anchor_;
  felt_ = look.felt.inverse() * felt_;
  seconds_felt_ -= look.seconds_felt;

  see_step(look);
  std::optional<Candidate> place;
  if (settings_.recall && anchor_ >= 0) place = recognise(look, result);
  if (place) {
    recall(look, *place, result);
    look.since_anchor = place->proven.motion;
  } else {
    constexpr double kTrusted = 10.0;  // keyframe distances since a place was recalled
    on_known_ground_ = on_known_ground_ && way_ - way_at_fix_ < kTrusted * keyframe_distance();
  }
  last_points_ = look.points;
  keyframe_frame_ = look.frame;
  if (anchor_ < 0 || has_moved_on(look)) make_node(std::move(look));
  since_keyframe_ = since_look;
  keyframe_ = since_anchor_ * since_look.inverse();
}

BrainResult Brain::process_missing(int frame, double timestamp, std::span<const SelfMotion> motions) {
  feel(motions);
  last_ = {};
  last_since_anchor_ = since_anchor_;
  if (anchor_ < 0) {  // somewhere the way must begin
    Look nothing;
    nothing.frame = frame;
    nothing.timestamp = timestamp;
    make_node(std::move(nothing));
  }
  BrainResult result;
  result.frame = frame;
  result.timestamp = timestamp;
  result.anchor = anchor_;
  result.since_anchor = since_anchor_;
  return result;
}

BrainResult Brain::process(StereoImages images, std::span<const SelfMotion> motions) {
  measurer_.check(images, camera_);
  const auto scope = timer_.measure("frame");
  BrainResult result;
  result.frame = images.index;
  result.timestamp = images.timestamp;
  feel(motions);
  if (is_keyframe_due()) take_keyframe(images, result);
  result.anchor = anchor_;
  result.since_anchor = since_anchor_;
  last_since_anchor_ = since_anchor_;
  last_ = std::move(images);
  return result;
}

}  // namespace penumbra::slam::brain
