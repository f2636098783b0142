#include "slam/pipeline/dense_mapper.h"

#include <algorithm>
#include <map>
#include <shared_mutex>

namespace penumbra::slam {

namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979;
constexpr std::size_t kMostClasses = kMoves;  // numbers below it

// Gives each class its number in the order of their names.
class ClassNumbers {
 public:
  explicit ClassNumbers(const std::vector<TrackedInstance>& instances) {
    for (const TrackedInstance& instance : instances) {
      of_instance_[instance.id] = instance.class_name;
      if (!instance.class_name.empty()) names_.push_back(instance.class_name);
    }
    std::sort(names_.begin(), names_.end());
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    names_.insert(names_.begin(), "");
    if (names_.size() > kMostClasses) names_.resize(kMostClasses);
  }
  const std::vector<std::string>& names() const { return names_; }

  // What the pixels of a sighting are called. People are never part of a map, whatever they do.
  std::uint8_t label_of(const InstanceSighting& seen) const {
    const auto found = of_instance_.find(seen.id);
    const std::string name = found == of_instance_.end() ? "" : found->second;
    if (seen.state == MotionState::moving || name == "person") return kMoves;
    const auto at = std::find(names_.begin(), names_.end(), name);
    return at == names_.end() ? std::uint8_t{0} : static_cast<std::uint8_t>(at - names_.begin());
  }

 private:
  std::map<int, std::string> of_instance_;
  std::vector<std::string> names_;
};

}  // namespace

void DenseMapper::add(const StereoCamera& camera, const StereoImages& images, const FrameResult& result) {
  if (!result.keyframe || result.place.reference == nullptr || images.depth.empty()) return;
  if (!kept_.empty()) {
    const SE3 step = last_T_wc_.inverse() * result.T_wc;
    const double degrees = so3_log(step.rotation).norm() * kDegrees;
    if (step.translation.norm() < settings_.least_metres && degrees < settings_.least_degrees) return;
  }
  last_T_wc_ = result.T_wc;
  kept_.push_back({result.index, result.place,
                   make_dense_view(camera, images.left, images.depth, settings_.step, settings_.farthest)});
}

DenseMap DenseMapper::build(const Recorder& record) {
  const ClassNumbers numbers(record.instances());
  std::vector<PosedView> views;
  std::size_t bytes = 0;
  {
    const std::shared_lock lock(record.slam().map().mutex());
    for (Kept& kept : kept_) {
      kept.view.label.fill(0);
      if (const auto seen = record.sightings().find(kept.frame); seen != record.sightings().end()) {
        for (const InstanceSighting& sighting : seen->second) {
          const std::uint8_t label = numbers.label_of(sighting);
          set_label(kept.view, settings_.step, sighting.region, sighting.mask, label,
                    label == kMoves ? settings_.grow : 0);
        }
      }
      views.push_back({&kept.view, kept.place.T_cw().inverse()});
      bytes += kept.view.bytes();
    }
  }
  DenseMap map{.voxels = fuse(views, settings_.fusion), .classes = numbers.names(), .floor = {}, .plan = {}};
  map.views = static_cast<int>(views.size());
  map.bytes = bytes + map.voxels.bytes();
  std::vector<Eigen::Vector3f> places;
  for (const Voxel& voxel : map.voxels.voxels()) places.push_back(voxel.place);
  std::vector<SE3> cameras;
  for (const PosedView& view : views) cameras.push_back(view.T_wc);
  map.floor = find_floor(places, cameras);
  if (map.floor) map.plan = occupancy_of(map.voxels, *map.floor, cameras.front(), settings_.plan);
  return map;
}

}  // namespace penumbra::slam
