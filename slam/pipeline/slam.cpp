#include "slam/pipeline/slam.h"

#include <cmath>
#include <iterator>
#include <shared_mutex>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/quantile.h"
#include "nn/base/stopwatch.h"
#include "nn/image/resize.h"

namespace penumbra::slam {

namespace {

const StereoCamera& checked(const StereoCamera& camera) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  if (!positive(camera.fx) || !positive(camera.fy) || !positive(camera.baseline) ||
      !std::isfinite(camera.cx) || !std::isfinite(camera.cy) || camera.width <= 0 || camera.height <= 0) {
    throw InputError("stereo camera", "focal lengths, baseline and image size above zero",
                     fmt::format("fx {} fy {} cx {} cy {} baseline {} size {}x{}", camera.fx, camera.fy,
                                 camera.cx, camera.cy, camera.baseline, camera.width, camera.height));
  }
  return camera;
}

// Metres, of the features that have a depth; 0 where none has.
double median_depth(const FrameFeatures& features) {
  std::vector<double> depths;
  for (int i = 0; i < features.size(); ++i) {
    if (features.has_stereo(i)) depths.push_back(features.depth[static_cast<std::size_t>(i)]);
  }
  return quantile_of(std::move(depths), 0.5);
}

// Sightings may be kept for every keyframe, so their masks are small.
std::vector<InstanceSighting> shrunk(std::vector<InstanceSighting> sightings) {
  constexpr double kLongestSide = 64.0;  // pixels
  for (InstanceSighting& seen : sightings) {
    const double scale = kLongestSide / std::max(seen.mask.width(), seen.mask.height());
    if (scale >= 1.0) continue;
    const auto side = [scale](int length) {
      return std::max(1, static_cast<int>(std::lrint(scale * length)));
    };
    seen.mask = resize_nearest<std::uint8_t>(seen.mask, {side(seen.mask.width()), side(seen.mask.height())});
  }
  return sightings;
}

// The loaded map, or an empty one.
std::unique_ptr<Map> starting_map(const StereoCamera& camera, std::unique_ptr<Map> loaded,
                                  const SlamSettings& settings) {
  std::vector<double> scales = level_scales(settings.orb.pyramid);
  if (settings.localise && (loaded == nullptr || loaded->keyframes().empty())) {
    throw InputError("localisation", "a map with keyframes", loaded ? "an empty one" : "none");
  }
  if (loaded == nullptr) return std::make_unique<Map>(camera, std::move(scales));
  if (loaded->scales() != scales) {
    throw InputError("loaded map",
                     fmt::format("features of {}, as they are found now", counted(scales.size(), "level")),
                     fmt::format("{}, or others", loaded->scales().size()));
  }
  return loaded;
}

}  // namespace

Slam::Slam(const StereoCamera& camera, Sensor sensor, const SlamSettings& settings, Segmenter segmenter,
           std::unique_ptr<Map> loaded)
    : camera_(checked(camera)),
      settings_(with_derived(settings, sensor, camera_)),
      measurer_(sensor, settings.orb, settings.threads),
      owned_map_(starting_map(camera_, std::move(loaded), settings)),
      map_(*owned_map_),
      first_own_keyframe_(map_.next_keyframe_id()),
      index_(settings.index),
      mapper_(map_, settings_.mapper),
      loop_closer_(map_, index_, settings.loops),
      tracker_(map_, index_, settings_.tracker, timer_,
               [this](const auto&... told) { return movers_.among_pairs(told...); }),
      instances_(camera_, map_.scales(), settings_.semantics.instances, map_.next_object_number()),
      movers_(camera_, map_.scales(), settings_.semantics.instances.companions,
              settings_.semantics.instances.motion, settings_.semantics.rigid_mover),
      static_points_(camera_, map_.scales(), settings_.semantics.static_points, instances_.history()),
      worker_(map_, mapper_, loop_closer_, settings_.full_bundle, !settings.deterministic),
      segmentation_(settings.semantics.mode == SegmentationMode::off ? Segmenter() : std::move(segmenter),
                    !settings.deterministic && settings.semantics.mode != SegmentationMode::all,
                    settings_.semantics.threads) {
  camera_ = map_.camera();
  loop_closer_.adopt_map();
  if (settings_.semantics.static_points.constraint.mode != StaticPointMode::off) {
    second_look_ = [this](const SE3& T_cw, const FeaturePixels& pixels, std::vector<char>& movable) {
      return find_what_stands(T_cw, pixels, movable);
    };
  }
}

SE3 FramePlace::T_wc() const { return proper_inverse(T_cw()); }

void Slam::keep_pace(double timestamp) {
  if (settings_.semantics.keeps_pace) segmentation_.keep_pace(timestamp - segmented_time_);
}

FrameResult Slam::process(const StereoImages& images) {
  measurer_.check(images, camera_);
  const Stopwatch watch;
  // What covers the view takes its share of the features: the rest of the street needs its own.
  constexpr double kMostFeatures = 2.5;
  const double more = std::min(kMostFeatures, 1.0 / std::max(0.1, 1.0 - instances_.covered_share()));
  tracker_.expect(images.step);
  const std::shared_ptr<const FrameFeatures> features =
      measurer_.measure(images, camera_, more, timer_, motion_to_depth(images));
  FrameResult result =
      process(images.timestamp, features, {images.index, images.left, images.depth, features});
  result.milliseconds = watch.milliseconds();
  timer_.add("frame", result.milliseconds);
  return result;
}

// How the camera moves from the colour image to the depth image, if it moves on as it did.
SE3 Slam::motion_to_depth(const StereoImages& images) const {
  if (images.depth_delay == 0.0 || !settings_.moves_depth) return {};
  return tracker_.predicted_step(images.timestamp + images.depth_delay) *
         tracker_.predicted_step(images.timestamp).inverse();
}

FrameResult Slam::process_missing(int index, double timestamp) {
  const Stopwatch watch;
  tracker_.expect(std::nullopt);
  FrameResult result = process(timestamp, std::make_shared<FrameFeatures>(), {index, {}, {}});
  result.milliseconds = watch.milliseconds();
  timer_.add("frame", result.milliseconds);
  return result;
}

FrameResult Slam::process(double timestamp, const std::shared_ptr<const FrameFeatures>& features,
                          const ImageToSegment& image) {
  const int index = image.frame;
  FrameResult result;
  result.index = index;
  result.timestamp = timestamp;
  take_instances();
  Frame& frame = newest_;
  frame.movable.assign(static_cast<std::size_t>(features->size()), 0);
  const FrameBeforePose unlocated{index, timestamp, features, tracker_.predicted_step(timestamp)};
  instances_.before_pose(unlocated, frame.movable);
  if (settings_.semantics.mode == SegmentationMode::all && !image.image.empty()) {
    segmentation_.submit(image);
    take_instances();
  }
  frame.index = index;
  frame.timestamp = timestamp;
  frame.features = features;
  frame.pyramid = &measurer_.pyramid();
  frame.right = image.image.empty() ? nullptr : &measurer_.right();
  frame.movable = instances_.movable();
  movers_.before_pose(unlocated, frame.movable);
  const Stopwatch reach;
  static_points_.before_pose(unlocated, frame.movable);
  const double reach_ms = reach.milliseconds();
  frame.covered_share = instances_.covered_share();
  frame.objects = instances_.objects();
  frame.T_cw = frame.T_c_reference = {};
  frame.reference = nullptr;
  frame.patches.reset();
  for (LastFrame* last : tracker_.compared()) {
    if (const std::vector<char>* known = instances_.movable(last->index()))
      last->set_movable(last->index(), *known);
  }
  result.covered_share = frame.covered_share;
  result.features = features->size();
  for (int i = 0; i < features->size(); ++i) {
    result.stereo_features += features->has_stereo(i);
    result.movable_features += frame.movable[static_cast<std::size_t>(i)] != 0;
  }
  result.median_depth = median_depth(*features);
  std::optional<MapWork> work;
  {
    const std::shared_lock lock(map_.mutex());
    result.tracking = tracker_.track(frame, second_look_);
    camera_ = map_.camera();  // of the next frame
    find_what_moves(frame, result.tracking);
    result.keyframe = result.tracking.wants_keyframe;
    if (result.keyframe) work = make_keyframe(frame, result.tracking.starts_submap);
  }
  result.static_points = static_points_.count();
  if (!result.tracking.second_pose) result.static_points.given_back = 0;
  if (second_look_) timer_.add("static_points", reach_ms + result.tracking.second_look_ms);
  result.segmented = is_segmented(result) && !image.image.empty();
  if (result.segmented) {
    segmented_time_ = timestamp;
    if (settings_.semantics.mode != SegmentationMode::all) segmentation_.submit(image);
  }
  if (work) worker_.submit(std::move(*work));

  result.T_wc = frame.T_cw.inverse();
  result.place = last_place_ = {frame.reference, frame.T_c_reference};
  result.findings = std::exchange(findings_, {});
  ++frames_;
  return result;
}

// What the frame, now that it was located, or given up, shows to move.
void Slam::find_what_moves(Frame& frame, const TrackingReport& report) {
  const auto scope = timer_.measure("movers");
  FrameAfterPose located{step_from_last(frame.T_cw), false, frame.pixels, report.mover};
  located.reliable = report.state == TrackingState::tracking && !report.recovered && !report.starts_submap;
  std::vector<Instance> found;
  for (Dynamics* dynamics : dynamics_) {
    for (Instance& mover : dynamics->after_pose(located, frame.movable)) found.push_back(std::move(mover));
  }
  for (const Instance& mover : found) instances_.add_mover(frame.index, mover);
  frame.movable = instances_.movable();
}

// How the camera moved from the last frame to this one. Both may have been moved by the map since.
SE3 Slam::step_from_last(const SE3& T_cw) const {
  return last_place_.reference == nullptr ? SE3{} : T_cw * last_place_.T_cw().inverse();
}

// What was left out, and stands still by the frame's first pose, is given back.
bool Slam::find_what_stands(const SE3& T_cw, const FeaturePixels& pixels, std::vector<char>& movable) {
  const FrameBetweenPoses located{step_from_last(T_cw), &pixels};
  bool any = false;
  for (Dynamics* dynamics : dynamics_) any |= dynamics->between_poses(located, movable);
  return any;
}

bool Slam::is_segmented(const FrameResult& frame) const {
  switch (settings_.semantics.mode) {
    case SegmentationMode::off:
    case SegmentationMode::keyframes:
      // What hides the way must be known most of all where the way is not.
      return frame.keyframe || frame.tracking.state != TrackingState::tracking ||
             frame.timestamp - segmented_time_ >= settings_.semantics.longest_gap_seconds;
    case SegmentationMode::interval:
      return frames_ % static_cast<std::size_t>(std::max(1, settings_.semantics.interval)) == 0;
    case SegmentationMode::all:
      break;
  }
  return true;
}

// What the segmenter has found meanwhile labels the frames that it belongs to, and all since.
void Slam::take_instances() {
  const auto scope = timer_.measure("instances");
  std::vector<TrackedInstance> gone = instances_.take_gone();
  std::move(gone.begin(), gone.end(), std::back_inserter(findings_.gone));
  for (SegmentedFrame& found : segmentation_.take()) {
    instances_.add(found.frame, found.instances);
    if (instances_.is_keyframe(found.frame))
      findings_.sightings.push_back({found.frame, shrunk(instances_.sightings(found.frame))});
    findings_.segmented.push_back(std::move(found));
  }
  for (Dynamics* dynamics : dynamics_) {
    MapWork work;
    work.edits = dynamics->take_edits();
    if (!work.edits.empty()) worker_.submit(std::move(work));
  }
}

// `frame` becomes a keyframe, which is still to be put into the map.
MapWork Slam::make_keyframe(Frame& frame, bool starts_submap) {
  MapWork work;
  work.tracked = frame.points;
  work.aligned = frame.aligned;
  work.keyframe = map_.new_keyframe(frame.index, frame.timestamp, frame.T_cw, frame.features);
  work.keyframe->patches = frame.patches;
  work.keyframe->pixels = frame.pixels;
  work.keyframe->movable = frame.movable;
  if (starts_submap) {
    work.keyframe->submap = map_.begin_submap();
  } else if (frame.reference != nullptr) {
    work.keyframe->submap = frame.reference->submap;
    work.reference = frame.reference;
    work.reference_T_cw = current_pose(*frame.reference);
  }
  tracker_.set_keyframe(work.keyframe.get());
  instances_.set_keyframe(work.keyframe.get());
  findings_.sightings.push_back({frame.index, shrunk(instances_.sightings())});
  // Those that earlier frames' results have shown; what is found in this one comes later.
  if (segmentation_.enabled()) work.edits.objects = instances_.take_keyframe_objects();
  frame.reference = work.keyframe.get();
  frame.T_c_reference = SE3{};
  return work;
}

Findings Slam::finish() {
  segmentation_.drain();
  take_instances();
  worker_.finish();
  timer_.merge(worker_.take_times());
  timer_.merge(segmentation_.take_times());
  timer_.merge(measurer_.take_times());
  return std::exchange(findings_, {});
}

FrameView Slam::newest_view() const {
  if (newest_.features == nullptr) return {};
  const std::shared_lock lock(map_.mutex());  // for which features are on what moves
  const std::vector<char>* movable = instances_.movable(newest_.index);
  const FeatureView features(*newest_.features, newest_.pixels, movable ? *movable : newest_.movable);
  return frame_view(features, newest_.points, instances_.sightings());
}

std::vector<ClosedLoop> Slam::loops() const {
  const std::shared_lock lock(map_.mutex());
  return loop_closer_.loops();
}

std::vector<RecognisedPlace> Slam::recognised_places() const {
  const std::shared_lock lock(map_.mutex());
  return loop_closer_.recognised();
}

Trajectory Slam::keyframe_trajectory() const {
  const std::shared_lock lock(map_.mutex());
  Trajectory trajectory;
  for (const KeyFrame* keyframe : map_.keyframes()) {
    if (is_loaded(*keyframe)) continue;
    trajectory.push_back({keyframe->timestamp, keyframe->T_cw.inverse()});
  }
  return trajectory;
}

}  // namespace penumbra::slam
