#include "slam/pipeline/dense_mapper.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <shared_mutex>

#include "nn/base/quantile.h"
#include "slam/dynamics/movable.h"
#include "slam/map/dense/displaced.h"

namespace penumbra::slam {

namespace {

constexpr double kStandingSeconds = 1.0;                    // between views from where the camera stands ...
constexpr int kMostStanding = 30;                           // ... of which no more are kept
constexpr double kAlikeMetres = 0.3, kAlikeDegrees = 15.0;  // between views that show much the same
constexpr double kDegrees = 180.0 / 3.14159265358979;
constexpr std::size_t kMostClasses = kMoves;  // numbers below it

// How far along the viewing direction the floor comes into the image at the middle of its lowest row: the
// median of the cameras that see it there.
double floor_from(const StereoCamera& camera, const FloorPlane& floor, const std::vector<SE3>& cameras) {
  const Eigen::Vector3d lowest(0.0, (camera.height - 1 - camera.cy) / camera.fy, 1.0);
  std::vector<double> distances;
  for (const SE3& T_wc : cameras) {
    const double falls = -floor.normal.dot(T_wc.rotation * lowest);
    if (falls > 0.0) distances.push_back(floor.height(T_wc.translation) / falls);
  }
  return distances.empty() ? 0.0 : quantile_of(distances, 0.5);
}

}  // namespace

// Gives each class its number in the order of their names.
class DenseMapper::ClassNumbers {
 public:
  explicit ClassNumbers(const Recorder& record) {
    for (const TrackedInstance& instance : record.instances()) {
      of_instance_[instance.id] = instance.class_name;
      if (is_vehicle_class(instance.class_name) && instance.measured &&
          instance.state() == MotionState::still)
        parked_.insert(instance.id);
      names_.push_back(instance.class_name);
    }
    for (const auto& [frame, instances] : record.masks()) {
      for (const Instance& instance : instances) names_.push_back(instance.class_name);
    }
    names_.emplace_back();  // the first, as nothing is less
    std::sort(names_.begin(), names_.end());
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    if (names_.size() > kMostClasses) names_.resize(kMostClasses);
  }
  const std::vector<std::string>& names() const { return names_; }

  // Whether it was seen to stand, of what can drive: it is in the way.
  bool is_parked(const InstanceSighting& seen) const { return parked_.contains(seen.id); }
  // What the pixels of a sighting are called.
  std::uint8_t label_of(const InstanceSighting& seen) const {
    const auto found = of_instance_.find(seen.id);
    if (is_parked(seen)) return number_of(found->second);
    return label_of(found == of_instance_.end() ? "" : found->second, seen.state == MotionState::moving);
  }
  // People and all else that can move are no part of a map, whatever they do.
  std::uint8_t label_of(const std::string& name, bool moves) const {
    return moves || is_movable_class(name) ? kMoves : number_of(name);
  }

 private:
  std::uint8_t number_of(const std::string& name) const {
    const auto at = std::find(names_.begin(), names_.end(), name);
    return at == names_.end() ? std::uint8_t{0} : static_cast<std::uint8_t>(at - names_.begin());
  }

  std::map<int, std::string> of_instance_;
  std::set<int> parked_;
  std::vector<std::string> names_;
};

// Whether it shows something that the last view that was kept does not.
bool DenseMapper::brings_something(const FrameResult& result) {
  const SE3 step = last_T_wc_.inverse() * result.T_wc;
  const double degrees = so3_log(step.rotation).norm() * kDegrees;
  if (kept_.empty() || step.translation.norm() >= settings_.least_metres ||
      degrees >= settings_.least_degrees) {
    standing_ = 0;
    return true;
  }
  if (result.timestamp - last_time_ < kStandingSeconds || standing_ >= kMostStanding) return false;
  ++standing_;
  return true;
}

bool DenseMapper::add(const StereoCamera& camera, const StereoImages& images, const FrameResult& result) {
  const bool located = result.tracking.state == TrackingState::tracking && result.place.reference != nullptr;
  const bool has_depth = !images.depth.empty();
  if (!result.segmented || !located || (!has_depth && images.right.empty()) || !brings_something(result))
    return false;
  last_T_wc_ = result.T_wc;
  last_time_ = result.timestamp;
  DenseView view;
  if (has_depth) {
    view = make_dense_view(camera, images.left, images.depth, settings_.step);
  } else {
    const auto scope = timer_.measure("stereo_depth");
    view = stereo_.make(camera, images);
  }
  kept_.push_back({result.index, result.place, std::move(view)});
  return true;
}

// Gives the pixels of the view their classes, and marks what moves. Things that were followed into the
// keyframe from others count, and what the segmenter saw in it.
void DenseMapper::label(Kept& kept, const Recorder& record, const ClassNumbers& numbers) const {
  const auto label_mask = [&](const Rect& region, const ByteImage& mask, std::uint8_t label) {
    set_label(kept.view, region, mask, label, label == kMoves ? settings_.grow : 0);
  };
  kept.view.label.fill(0);
  std::vector<Rect> parked;
  if (const auto seen = record.sightings().find(kept.frame); seen != record.sightings().end()) {
    for (const InstanceSighting& sighting : seen->second) {
      label_mask(sighting.region, sighting.mask, numbers.label_of(sighting));
      if (numbers.is_parked(sighting)) parked.push_back(sighting.region);
    }
  }
  const auto is_parked = [&](const Instance& instance) {
    return is_vehicle_class(instance.class_name) &&
           std::any_of(parked.begin(), parked.end(), [&](const Rect& region) {
             return 2 * intersection(region, instance.region).area() >=
                    bounding(region, instance.region).area();
           });
  };
  if (const auto seen = record.masks().find(kept.frame); seen != record.masks().end()) {
    for (const Instance& instance : seen->second) {
      if (is_parked(instance)) continue;  // the sighting of it counts
      label_mask(instance.region, instance.mask,
                 numbers.label_of(instance.class_name, instance.moves.value_or(false)));
    }
  }
}

// Marks things of any class that other views show elsewhere.
void DenseMapper::mark_displaced(const Recorder& record, const std::vector<PosedView>& views) {
  std::vector<ShownThing> things;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (const auto seen = record.masks().find(kept_[i].frame); seen != record.masks().end()) {
      for (const Instance& thing : seen->second) things.push_back({i, thing.region, &thing.mask});
    }
  }
  const std::vector<char> displaced = find_displaced(things, views, settings_.fusion);
  for (std::size_t i = 0; i < things.size(); ++i) {
    const auto& [view, region, mask] = things[i];
    if (displaced[i]) set_label(kept_[view].view, region, *mask, kMoves, settings_.grow);
  }
}

// Leaves out views that the segmenter did not see where one that it saw shows the same: whoever stands in
// them may have been overlooked.
void DenseMapper::leave_out_unsegmented(const Recorder& record, const std::vector<PosedView>& views) {
  const auto is_segmented = [&](std::size_t i) { return record.masks().contains(kept_[i].frame); };
  const auto alike = [](const SE3& a, const SE3& b) {
    return (a.translation - b.translation).norm() <= kAlikeMetres &&
           a.rotation.col(2).dot(b.rotation.col(2)) >= std::cos(kAlikeDegrees / kDegrees);
  };
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (is_segmented(i)) continue;
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      if (!is_segmented(k) || !alike(views[i].T_wc, views[k].T_wc)) continue;
      kept_[i].view.label.fill(kMoves);
      break;
    }
  }
}

DenseMap DenseMapper::build(const Recorder& record) {
  const ClassNumbers numbers(record);
  std::vector<PosedView> views;
  std::size_t bytes = 0;
  {
    const Map& map = record.slam().map();
    const std::shared_lock lock(map.mutex());
    for (Kept& kept : kept_) {
      // What the whole map has told of the pair since.
      correct_disparity_offset(kept.view, map.camera().disparity_offset / kept.view.step);
      views.push_back({&kept.view, kept.place.T_cw().inverse()});
      bytes += kept.view.bytes();
    }
  }
  for (Kept& kept : kept_) label(kept, record, numbers);
  mark_displaced(record, views);
  leave_out_unsegmented(record, views);
  DenseMap map{.voxels = fuse(views, settings_.fusion), .classes = numbers.names(), .floor = {}, .plan = {}};
  map.views = static_cast<int>(views.size());
  map.bytes = bytes + map.voxels.bytes();
  std::vector<Eigen::Vector3f> places;
  for (const Voxel& voxel : map.voxels.voxels()) places.push_back(voxel.place);
  std::vector<SE3> cameras;
  for (const PosedView& view : views) cameras.push_back(view.T_wc);
  constexpr double kFloorShare = 0.25;  // of the height from which on something blocks
  map.floor = find_floor(places, cameras, kFloorShare * settings_.plan.lowest);
  if (map.floor) map.floor_from = floor_from(record.slam().map().camera(), *map.floor, cameras);
  if (map.floor) map.plan = occupancy_of(map.voxels, *map.floor, cameras.front(), settings_.plan);
  return map;
}

}  // namespace penumbra::slam
