#include "slam/dynamics/movers.h"

#include "slam/dynamics/frame_history.h"
#include "slam/dynamics/point_origin.h"

namespace penumbra::slam {

void Movers::before_pose(const FrameBeforePose& frame, std::vector<char>& /*movable*/) {
  features_ = frame.features;
  index_ = frame.index;
  time_ = usable_time(frame.time, frame.index);
}

WorldPose Movers::among_pairs(const PosePairs& pairs, std::vector<char>* movable) const {
  SeparatedMotions motions = separate_motions(pairs.camera, pairs.observations, pairs.dominant,
                                              pairs.predicted, static_cast<std::uint64_t>(index_), rigid_);
  if (motions.mover && movable != nullptr) mark_mover(motions, *features_, *movable);
  return {std::move(motions.world), std::move(motions.mover)};
}

std::vector<Instance> Movers::after_pose(const FrameAfterPose& frame, std::vector<char>& movable) {
  T_co_ = any_ ? frame.T_step * T_co_ : SE3{};
  any_ = true;
  std::vector<Instance> found;
  if (settings_.enabled) {
    const FeatureView view(*features_, frame.pixels, movable);
    std::vector<PointOrigin> origins;
    for (int i = 0; i < view.size(); ++i)
      origins.push_back(point_origin(camera_, scales_, view, i, T_co_, time_, motion_));
    std::optional<Instance> companion = companions_.observe(features_, frame.pixels, movable,
                                                            std::move(origins), T_co_, time_, frame.reliable);
    if (companion) found.push_back(std::move(*companion));
  }
  if (frame.mover) found.push_back(*frame.mover);
  return found;
}

}  // namespace penumbra::slam
