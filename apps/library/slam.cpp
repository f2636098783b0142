#include "penumbra/slam.h"

#include <fmt/core.h>

#include <cmath>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "apps/library/pixels.h"
#include "apps/library/poses.h"
#include "apps/library/rig.h"
#include "apps/network/loaded_network.h"
#include "apps/slam/segmenter.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/image/levels.h"
#include "slam/map/map_file.h"
#include "slam/map/ply.h"
#include "slam/pipeline/dynamics_choice.h"
#include "slam/pipeline/run_check.h"
#include "slam/pipeline/settings_file.h"
#include "slam/pipeline/slam.h"
#include "weights_tools/load_weights.h"

namespace penumbra {

namespace {

slam::SlamSettings settings_of(const SlamOptions& options, slam::Sensor sensor) {
  slam::SlamSettings settings;
  if (!options.settings.empty()) slam::read_settings(options.settings, settings);
  settings.threads = options.threads > 0 ? options.threads : thread_count();
  settings.deterministic = options.deterministic;
  if (options.localise) settings.localise = true;
  if (options.dynamics.empty() && !options.settings.empty()) return settings;
  const std::string dynamics = options.dynamics.empty() ? "masks" : options.dynamics;
  if (!slam::choose_dynamics(dynamics, settings.semantics))
    throw InputError("SlamOptions::dynamics", "masks, boxes, depth-clusters or static-points", dynamics);
  if (slam::needs_depth(settings.semantics.depth_masks.masks) && sensor != slam::Sensor::rgbd)
    throw InputError("SlamOptions::dynamics", "masks or boxes for a rig without depth", dynamics);
  settings.semantics.instances.check_motion = !slam::class_decides(settings.semantics);
  return settings;
}

State state_of(slam::TrackingState state) {
  switch (state) {
    case slam::TrackingState::tracking:
      return State::tracking;
    case slam::TrackingState::occluded:
      return State::occluded;
    case slam::TrackingState::lost:
      return State::lost;
    case slam::TrackingState::initialising:
      break;
  }
  return State::initialising;
}

std::optional<std::array<double, 36>> covariance_of(const slam::Matrix6d& information) {
  if (information.isZero()) return std::nullopt;
  const slam::Matrix6d inverse = information.inverse();
  const slam::Matrix6d covariance = 0.5 * (inverse + inverse.transpose());
  if (!covariance.allFinite()) return std::nullopt;
  std::array<double, 36> rows{};
  for (int i = 0; i < 36; ++i) rows[static_cast<std::size_t>(i)] = covariance(i / 6, i % 6);
  return rows;
}

}  // namespace

class Slam::Run {
 public:
  Run(Rig rig, SlamOptions options) : rig_(std::move(rig)), options_(std::move(options)) {
    settings_ = settings_of(options_, parts().sensor);
    if (!options_.weights.empty()) {
      network_ = apps::network_of(weights_tools::load_weights(options_.weights), options_.weights, {},
                                  apps::slam_network_config());
      if (options_.settings.empty())
        settings_.semantics.instances.least_score = apps::least_score_of(*network_);
    }
    begin();
  }

  void begin() {
    std::unique_ptr<slam::Map> map;
    if (!options_.map.empty()) {
      map = slam::read_map(options_.map);
      slam::require_same_camera(map->camera(), cameras().camera, options_.map);
    }
    slam::Segmenter segmenter;
    if (network_) segmenter = apps::make_segmenter(*network_, cameras().camera, settings_.semantics);
    auto slam = std::make_shared<slam::Slam>(cameras().camera, parts().sensor, settings_,
                                             std::move(segmenter), std::move(map));
    check_.emplace(cameras().camera, parts().sensor);
    places_.clear();
    frames_ = 0;
    last_ = {};
    const std::lock_guard lock(mutex_);
    slam_ = std::move(slam);
  }

  TrackResult track(const Frame& frame) {
    const ThreadCountScope threads(settings_.threads);
    const slam::StereoImages images = images_of(frame);
    slam::FrameResult found = slam_->process(images);
    const slam::SE3 T_wc = take_place({images.timestamp, found.place}, found.T_wc);
    if (options_.keeps_trajectory) places_.push_back(last_);
    ++frames_;
    check_->add(images, found);
    TrackResult result;
    result.frame = found.index;
    result.timestamp = found.timestamp;
    result.state = state_of(found.tracking.state);
    result.T_world_camera = pose_of(T_wc);
    if (result.state == State::tracking) result.covariance = covariance_of(found.tracking.information);
    result.inliers = found.tracking.map_inliers;
    result.keyframe = found.keyframe;
    result.recovered = found.tracking.recovered;
    result.new_piece = found.tracking.starts_submap;
    result.why_lost = check_->newest_reason();
    result.warnings = check_->take_warnings();
    return result;
  }

  void finish() {
    slam_->finish();
    tell_movement(last_.place.T_wc());  // no other thread writes any more
  }

  void save(const std::string& path) {
    finish();
    slam::write_map(path, slam_->map());
  }

  MapSnapshot snapshot() const {
    const std::shared_ptr<const slam::Slam> slam = current();
    MapSnapshot shown;
    for (const slam::TimedPose& pose : slam->keyframe_trajectory())
      shown.keyframes.push_back({pose.timestamp, pose_of(pose.T_wc)});
    const slam::PointCloud cloud = slam::point_cloud_of(slam->map());
    const std::size_t points = cloud.vertices.size() - static_cast<std::size_t>(cloud.keyframes);
    shown.points.reserve(points);
    for (std::size_t i = 0; i < points; ++i)
      shown.points.push_back({cloud.vertices[i].position, cloud.vertices[i].colour});
    shown.loops = static_cast<int>(slam->loops().size());
    return shown;
  }

  std::vector<TimedPose> trajectory() const {
    const std::shared_lock lock(slam_->map().mutex());
    std::vector<TimedPose> poses;
    poses.reserve(places_.size());
    for (const Place& at : places_) poses.push_back({at.timestamp, pose_of(at.place.T_wc())});
    return poses;
  }

  std::function<void(const Pose&)> told;

 private:
  struct Place {
    double timestamp = 0.0;
    slam::FramePlace place;
  };

  const Rig::Parts& parts() const { return *rig_.parts_; }
  const slam::RecordedCamera& cameras() const { return parts().cameras; }
  std::shared_ptr<const slam::Slam> current() const {
    const std::lock_guard lock(mutex_);
    return slam_;
  }

  slam::StereoImages images_of(const Frame& frame) const {
    if (!std::isfinite(frame.timestamp) || (frames_ > 0 && frame.timestamp <= last_.timestamp)) {
      throw InputError(fmt::format("frame {}", frames_),
                       fmt::format("a time after {:.6f} s", last_.timestamp),
                       fmt::format("{:.6f} s", frame.timestamp));
    }
    const Size size{parts().width, parts().height};
    slam::StereoImages images;
    images.index = frames_;
    images.timestamp = frame.timestamp;
    images.left = cameras().left.linear(byte_image_of(frame.left, size, "left image"));
    if (parts().sensor == slam::Sensor::stereo) {
      images.right = cameras().right.linear(byte_image_of(frame.right, size, "right image"));
    } else {
      images.depth = metres_of(frame.depth, size);
    }
    if (frame.motion) images.step = motion_of(*frame.motion, "motion of a frame");
    return images;
  }

  FloatImage metres_of(const ImageRef& image, const Size& size) const {
    if (image.format == PixelFormat::depth32_metres) {
      if (!cameras().left.is_identity())
        throw InputError("depth", "16-bit depth where the rig's images are raw", "floats");
      return depth_metres_of(image, size);
    }
    if (image.format != PixelFormat::depth16)
      throw InputError("depth", "16-bit depth, or metres as floats", "grey or colour");
    return penumbra::metres_of(cameras().left.nearest(depth_units_of(image, size)), parts().depth_factor);
  }

  // The pose of a frame that was just located, in the map as it is now: that may have moved since, by a loop
  // that this very frame closed. What it moved is told by the frame before, at the same moment of the map.
  slam::SE3 take_place(const Place& place, const slam::SE3& T_wc_found) {
    slam::SE3 before, now = T_wc_found;
    {
      const std::shared_lock lock(slam_->map().mutex());
      before = last_.place.T_wc();
      if (place.place.reference != nullptr) now = place.place.T_wc();
    }
    tell_movement(before);
    last_ = place;
    last_told_ = now;
    return now;
  }
  // `now`: of the newest frame whose pose was told, T_wc.
  void tell_movement(const slam::SE3& now) {
    constexpr double kMetres = 0.01, kRadians = 0.0017;
    if (frames_ == 0 || last_.place.reference == nullptr) return;
    const slam::SE3 moved = now * last_told_.inverse();
    const bool is_far = (now.translation - last_told_.translation).norm() > kMetres;
    if (!is_far && moved.angle() <= kRadians) return;
    last_told_ = now;
    if (told) told(pose_of(moved));
  }

  const Rig rig_;
  const SlamOptions options_;
  slam::SlamSettings settings_;
  std::optional<apps::LoadedNetwork> network_;
  mutable std::mutex mutex_;  // of slam_ itself: snapshot() may come while reset() makes another
  std::shared_ptr<slam::Slam> slam_;
  std::optional<slam::RunCheck> check_;
  std::vector<Place> places_;
  int frames_ = 0;
  Place last_;           // of the newest frame; its timestamp counts where it has no place, too
  slam::SE3 last_told_;  // T_wc
};

Slam::Slam(Rig rig, SlamOptions options) : run_(std::make_unique<Run>(std::move(rig), std::move(options))) {}

Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

TrackResult Slam::track(const Frame& frame) { return run_->track(frame); }
void Slam::on_map_changed(std::function<void(const Pose&)> told) { run_->told = std::move(told); }
MapSnapshot Slam::snapshot() const { return run_->snapshot(); }
std::vector<TimedPose> Slam::trajectory() const { return run_->trajectory(); }
void Slam::finish() { run_->finish(); }
void Slam::save_map(const std::string& path) { run_->save(path); }
void Slam::reset() { run_->begin(); }

}  // namespace penumbra
