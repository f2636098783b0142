#include "slam/pipeline/kept_frames.h"

#include <shared_mutex>

namespace penumbra::slam {

FramePlace KeptFrame::place() const {
  const Eigen::Map<const Eigen::Matrix3d> rotation(T_c_reference.data());
  const Eigen::Map<const Eigen::Vector3d> translation(T_c_reference.data() + 9);
  return {reference, {rotation, translation}};
}

void KeptFrames::add(const FrameResult& result) {
  KeptFrame frame;
  frame.timestamp = result.timestamp;
  frame.milliseconds = result.milliseconds;
  frame.covered_share = result.covered_share;
  frame.reference = result.place.reference;
  Eigen::Map<Eigen::Matrix3d>(frame.T_c_reference.data()) = result.place.T_c_reference.rotation;
  Eigen::Map<Eigen::Vector3d>(frame.T_c_reference.data() + 9) = result.place.T_c_reference.translation;
  frame.index = result.index;
  frame.features = result.features;
  frame.stereo_features = result.stereo_features;
  frame.movable_features = result.movable_features;
  frame.frame_matches = result.tracking.frame_matches;
  frame.map_inliers = result.tracking.map_inliers;
  frame.static_points = result.static_points;
  frame.state = result.tracking.state;
  frame.keyframe = result.keyframe;
  frame.starts_submap = result.tracking.starts_submap;
  const MismatchFilterReport& filter = result.tracking.filter;
  frame.filter_kept = filter.kept;
  frame.filter_removed = filter.removed;
  frame.first_bar = bars_.size();
  frame.bars = static_cast<int>(filter.bins.size());
  if (!filter.bins.empty()) {
    frame.bar_from = filter.bins.front().from;
    frame.bar_width = filter.bins.front().to - filter.bins.front().from;
  }
  for (const MismatchFilterReport::Bin& bin : filter.bins) bars_.push_back({bin.kept, bin.removed});
  frames_.push_back(frame);
  if (frame.reference != nullptr) references_.insert(frame.reference);
}

std::vector<FilterBar> KeptFrames::bars(const KeptFrame& frame) const {
  std::vector<FilterBar> bars;
  for (int b = 0; b < frame.bars; ++b) bars.push_back(bars_[frame.first_bar + static_cast<std::uint64_t>(b)]);
  return bars;
}

KeptFrames::Poses KeptFrames::poses() const {
  const std::shared_lock lock(map_->mutex());
  Poses poses;
  for (const KeyFrame* reference : references_)
    poses.T_reference_w_.emplace(reference, current_pose(*reference));
  return poses;
}

SE3 KeptFrames::Poses::of(const KeptFrame& frame) const {
  const FramePlace place = frame.place();
  if (place.reference == nullptr) return {};
  return proper_inverse(place.T_c_reference * T_reference_w_.at(place.reference));
}

Trajectory KeptFrames::trajectory() const {
  const Poses now = poses();
  Trajectory trajectory;
  trajectory.reserve(frames_.size());
  for (const KeptFrame& frame : frames_) trajectory.push_back({frame.timestamp, now.of(frame)});
  return trajectory;
}

}  // namespace penumbra::slam
