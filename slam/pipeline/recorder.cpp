#include "slam/pipeline/recorder.h"

#include <algorithm>
#include <shared_mutex>
#include <utility>

#include "nn/image/resize.h"

namespace penumbra::slam {

FramePlace KeptFrame::place() const {
  const Eigen::Map<const Eigen::Matrix3d> rotation(T_c_reference.data());
  const Eigen::Map<const Eigen::Vector3d> translation(T_c_reference.data() + 9);
  return {reference, {rotation, translation}};
}

const FrameResult& Recorder::add(FrameResult result) {
  Findings findings = std::exchange(result.findings, {});
  result.tracking.mover.reset();  // its mask is large, and no report shows it
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
  tracked_ += frame.is_located();
  note_delays(findings.segmented);
  keep(std::move(findings));
  newest_ = std::move(result);
  return newest_;
}

std::vector<FilterBar> Recorder::bars(const KeptFrame& frame) const {
  std::vector<FilterBar> bars;
  for (int b = 0; b < frame.bars; ++b) bars.push_back(bars_[frame.first_bar + static_cast<std::uint64_t>(b)]);
  return bars;
}

// Of what the newest frame was told.
void Recorder::note_delays(const std::vector<SegmentedFrame>& found) {
  for (const SegmentedFrame& seen : found) {
    const double now = frames_.back().timestamp;
    for (std::size_t i = frames_.size(); i-- > 0;) {
      const KeptFrame shown = frames_[i];
      if (shown.index != seen.frame) continue;
      mask_delays_.add(now - shown.timestamp);
      break;
    }
  }
}

void Recorder::finish() { keep(slam_.finish()); }

void Recorder::keep(Findings findings) {
  for (KeyframeSightings& seen : findings.sightings) sightings_[seen.frame] = std::move(seen.sightings);
  std::move(findings.gone.begin(), findings.gone.end(), std::back_inserter(gone_));
  for (SegmentedFrame& found : findings.segmented) {
    if (!with_masks_.contains(found.frame)) continue;
    for (Instance& instance : found.instances) {
      const Size half{std::max(1, instance.mask.width() / 2), std::max(1, instance.mask.height() / 2)};
      if (!instance.mask.empty()) instance.mask = resize_nearest<std::uint8_t>(instance.mask, half);
    }
    masks_[found.frame] = std::move(found.instances);
  }
}

Trajectory Recorder::trajectory() const {
  const std::shared_lock lock(slam_.map().mutex());
  Trajectory trajectory;
  trajectory.reserve(frames_.size());
  for (const KeptFrame& frame : frames_) trajectory.push_back({frame.timestamp, frame.place().T_wc()});
  return trajectory;
}

std::vector<SubmapSummary> Recorder::submaps() const {
  const std::shared_lock lock(slam_.map().mutex());
  std::map<int, SubmapSummary> submaps;
  for (const KeyFrame* keyframe : slam_.map().keyframes()) {
    SubmapSummary& submap = submaps[keyframe->submap];
    submap.submap = keyframe->submap;
    ++submap.keyframes;
  }
  for (const KeptFrame& frame : frames_) {
    const KeyFrame* reference = frame.reference;
    if (reference == nullptr || !frame.is_located()) continue;
    while (reference->erased) reference = reference->stand_in;
    SubmapSummary& submap = submaps[reference->submap];
    if (submap.frames++ == 0) submap.first_frame = frame.index;
    submap.last_frame = frame.index;
  }
  std::vector<SubmapSummary> in_order;
  for (const auto& [number, submap] : submaps) in_order.push_back(submap);
  return in_order;
}

std::vector<TrackedInstance> Recorder::instances() const {
  std::vector<TrackedInstance> all = slam_.instances();
  all.insert(all.end(), gone_.begin(), gone_.end());
  std::sort(all.begin(), all.end(),
            [](const TrackedInstance& a, const TrackedInstance& b) { return a.id < b.id; });
  return all;
}

}  // namespace penumbra::slam
