#include "slam/pipeline/slam.h"

#include <cmath>
#include <future>
#include <iterator>
#include <shared_mutex>

#include "nn/base/error.h"
#include "nn/base/quantile.h"
#include "nn/base/stopwatch.h"
#include "nn/image/grey.h"
#include "nn/image/resize.h"
#include "slam/frontend/features/depth_measurement.h"

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

void check_image(const ByteImage& image, const StereoCamera& camera, int index, const char* side) {
  if (image.width() == camera.width && image.height() == camera.height &&
      (image.channels() == 1 || image.channels() == 3)) {
    return;
  }
  throw InputError(fmt::format("frame {}, {} image", index, side),
                   fmt::format("{}x{}, 8-bit grey or BGR", camera.width, camera.height),
                   fmt::format("{}x{} with {} channels", image.width(), image.height(), image.channels()));
}

void check_depth(const FloatImage& depth, const StereoCamera& camera, int index) {
  if (depth.width() == camera.width && depth.height() == camera.height && depth.channels() == 1) return;
  throw InputError(fmt::format("frame {}, depth", index),
                   fmt::format("{}x{}, metres as 32-bit floats", camera.width, camera.height),
                   fmt::format("{}x{} with {} channels", depth.width(), depth.height(), depth.channels()));
}

// Colour of the image at each keypoint.
std::vector<std::array<std::uint8_t, 3>> colours_at(const ByteImage& image,
                                                    const std::vector<Keypoint>& keypoints) {
  std::vector<std::array<std::uint8_t, 3>> colours;
  colours.reserve(keypoints.size());
  for (const Keypoint& k : keypoints) {
    const int x = static_cast<int>(std::lround(k.u)), y = static_cast<int>(std::lround(k.v));
    const std::uint8_t* c = &image.at(x, y);
    const int step = image.channels() == 3 ? 1 : 0;
    colours.push_back({c[0], c[step], c[2 * step]});
  }
  return colours;
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

// What follows from the sensor, the camera and other settings, for every caller.
SlamSettings derived(SlamSettings settings, Sensor sensor, const StereoCamera& camera) {
  const double close = close_depth(camera, settings.mapper.point_creation);
  settings.tracker.keyframes.close_depth = settings.semantics.instances.close_depth = close;
  settings.tracker.extends_map = !settings.localise;
  // Threads of a bundle adjustment: what is there, less the tracker's where that goes on meanwhile.
  const int threads = std::max(1, settings.deterministic ? settings.threads : settings.threads - 1);
  settings.mapper.bundle.threads = settings.full_bundle.threads = threads;
  // Beside the tracker, with as many threads as processors, those would wait for each other.
  if (settings.semantics.threads == 0) settings.semantics.threads = std::max(1, settings.threads - 1);
  // The right columns of an RGB-D camera follow from its depth: they have no offset of their own.
  if (sensor == Sensor::rgbd) settings.full_bundle.disparity_offset_sigma = 0.0;
  return settings;
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
    throw InputError("loaded map", fmt::format("features of {} levels, as they are found now", scales.size()),
                     fmt::format("{}, or others", loaded->scales().size()));
  }
  return loaded;
}

}  // namespace

Slam::Slam(const StereoCamera& camera, Sensor sensor, const SlamSettings& settings, Segmenter segmenter,
           std::unique_ptr<Map> loaded)
    : camera_(checked(camera)),
      sensor_(sensor),
      settings_(derived(settings, sensor, camera_)),
      left_orb_(settings.orb),
      right_orb_(settings.orb),
      owned_map_(starting_map(camera_, std::move(loaded), settings)),
      map_(*owned_map_),
      first_own_keyframe_(map_.next_keyframe_id()),
      index_(settings.index),
      mapper_(map_, settings_.mapper),
      loop_closer_(map_, index_, settings.loops),
      tracker_(map_, index_, settings_.tracker, timer_),
      instances_(camera_, map_.scales(), settings_.semantics.instances, map_.next_object_number()),
      movers_(camera_, map_.scales(), settings_.semantics.instances.companions,
              settings_.semantics.instances.motion),
      worker_(map_, mapper_, loop_closer_, settings_.full_bundle, !settings.deterministic),
      segmentation_(settings.semantics.mode == SegmentationMode::off ? Segmenter() : std::move(segmenter),
                    !settings.deterministic && settings.semantics.mode != SegmentationMode::all,
                    settings_.semantics.threads) {
  camera_ = map_.camera();
  loop_closer_.adopt_map();
}

FrameResult Slam::process(const StereoImages& images) {
  check_image(images.left, camera_, images.index, "left");
  if (sensor_ == Sensor::stereo) {
    check_image(images.right, camera_, images.index, "right");
  } else {
    check_depth(images.depth, camera_, images.index);
  }
  const Stopwatch watch;
  const std::shared_ptr<const FrameFeatures> features = measure(images);
  FrameResult result = process(images.timestamp, features, {images.index, images.left, images.depth});
  result.milliseconds = watch.milliseconds();
  timer_.add("frame", result.milliseconds);
  return result;
}

FrameResult Slam::process_missing(int index, double timestamp) {
  const Stopwatch watch;
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
  for (Dynamics* dynamics : dynamics_) dynamics->before_pose(unlocated, frame.movable);
  if (settings_.semantics.mode == SegmentationMode::all && !image.image.empty()) {
    segmentation_.submit(image);
    take_instances();
  }
  frame.index = index;
  frame.timestamp = timestamp;
  frame.features = features;
  frame.pyramid = &left_orb_.pyramid();
  frame.movable = instances_.movable();
  frame.covered_share = instances_.covered_share();
  frame.objects = instances_.objects();
  frame.T_cw = frame.T_c_reference = {};
  frame.reference = nullptr;
  frame.patches.reset();
  if (const std::vector<char>* known = instances_.movable(tracker_.last().index()))
    tracker_.last().set_movable(tracker_.last().index(), *known);
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
    result.tracking = tracker_.track(frame);
    camera_ = map_.camera();  // of the next frame
    find_what_moves(frame, result.tracking);
    result.keyframe = result.tracking.wants_keyframe;
    if (result.keyframe) work = make_keyframe(frame, result.tracking.starts_submap);
  }
  if (is_segmented(result) && !image.image.empty()) segmentation_.submit(image);
  if (work) worker_.submit(std::move(*work));

  result.T_wc = frame.T_cw.inverse();
  result.place = last_place_ = {frame.reference, frame.T_c_reference};
  result.findings = std::exchange(findings_, {});
  ++frames_;
  return result;
}

// Features of the left image, and where each would be seen from the right: by matching, or by its depth.
std::shared_ptr<const FrameFeatures> Slam::measure(const StereoImages& images) {
  auto measured = std::make_shared<FrameFeatures>();
  const ByteImage left = to_grey(images.left);
  // What covers the view takes its share of the features: the rest of the street needs its own.
  constexpr double kMostFeatures = 2.5;
  const double more = std::min(kMostFeatures, 1.0 / std::max(0.1, 1.0 - instances_.covered_share()));
  StereoMatches stereo;
  if (sensor_ == Sensor::stereo) {
    const ByteImage right = to_grey(images.right);
    Features right_features;
    {
      const auto scope = timer_.measure("orb");
      const auto policy = settings_.threads > 1 ? std::launch::async : std::launch::deferred;
      std::future<void> right_done =
          std::async(policy, [&] { right_orb_.extract(right, right_features, more); });
      left_orb_.extract(left, measured->left, more);
      right_done.get();
    }
    const auto scope = timer_.measure("stereo");
    match_stereo(camera_, measured->left, right_features, left_orb_.pyramid(), right_orb_.pyramid(), stereo);
    stereo_order_.check(images.index, camera_, measured->left, right_features, left_orb_.pyramid(),
                        right_orb_.pyramid(), stereo);
  } else {
    {
      const auto scope = timer_.measure("orb");
      left_orb_.extract(left, measured->left, more);
    }
    const auto scope = timer_.measure("stereo");
    measure_depth(camera_, measured->left, images.depth, stereo);
  }
  measured->u_right = std::move(stereo.u_right);
  measured->depth = std::move(stereo.depth);
  measured->colour = colours_at(images.left, measured->left.keypoints);
  measured->grid = FeatureGrid(measured->left.keypoints, camera_.width, camera_.height);
  return measured;
}

// What the frame, now that it was located, or given up, shows to move.
void Slam::find_what_moves(Frame& frame, const TrackingReport& report) {
  FrameAfterPose located{step_from_last(frame), false, frame.pixels, report.mover};
  located.reliable = report.state == TrackingState::tracking && !report.recovered && !report.starts_submap;
  std::vector<Instance> found;
  for (Dynamics* dynamics : dynamics_) {
    for (Instance& mover : dynamics->after_pose(located, frame.movable)) found.push_back(std::move(mover));
  }
  for (const Instance& mover : found) instances_.add_mover(frame.index, mover);
  frame.movable = instances_.movable();
}

// How the camera moved from the last frame to this one. Both may have been moved by the map since.
SE3 Slam::step_from_last(const Frame& frame) const {
  return last_place_.reference == nullptr ? SE3{} : frame.T_cw * last_place_.T_cw().inverse();
}

bool Slam::is_segmented(const FrameResult& frame) const {
  constexpr int kWithoutKeyframes = 3;  // frames; a drive makes every second or third a keyframe
  const auto is_turn_of = [&](int interval) {
    return frames_ % static_cast<std::size_t>(std::max(1, interval)) == 0;
  };
  switch (settings_.semantics.mode) {
    case SegmentationMode::keyframes:
      // What hides the way must be known most of all where the way is not.
      return frame.keyframe || frame.tracking.state != TrackingState::tracking ||
             (settings_.localise && is_turn_of(kWithoutKeyframes));
    case SegmentationMode::interval:
      return is_turn_of(settings_.semantics.interval);
    case SegmentationMode::off:
    case SegmentationMode::all:  // before the frame is located
      break;
  }
  return false;
}

// What the segmenter has found meanwhile labels the frames that it belongs to, and all since.
void Slam::take_instances() {
  const auto scope = timer_.measure("instances");
  std::vector<TrackedInstance> gone = instances_.take_gone();
  std::move(gone.begin(), gone.end(), std::back_inserter(findings_.gone));
  const std::vector<SegmentedFrame> results = segmentation_.take();
  for (const SegmentedFrame& found : results) {
    instances_.add(found.frame, found.instances);
    if (instances_.is_keyframe(found.frame))
      findings_.sightings.push_back({found.frame, shrunk(instances_.sightings(found.frame))});
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
