#include "slam/pipeline/recorder.h"

#include <algorithm>
#include <shared_mutex>
#include <utility>

#include "nn/image/resize.h"

namespace penumbra::slam {

const FrameResult& Recorder::add(FrameResult result) {
  Findings findings = std::exchange(result.findings, {});
  result.tracking.mover.reset();  // its mask is large, and no report shows it
  tracked_ += result.tracking.state == TrackingState::tracking;
  results_.push_back(std::move(result));
  note_delays(findings.segmented);
  keep(std::move(findings));
  return results_.back();
}

// Of what the newest frame was told.
void Recorder::note_delays(const std::vector<SegmentedFrame>& found) {
  for (const SegmentedFrame& seen : found) {
    const auto shown = std::find_if(results_.rbegin(), results_.rend(),
                                    [&](const FrameResult& result) { return result.index == seen.frame; });
    if (shown != results_.rend()) mask_delays_.add(results_.back().timestamp - shown->timestamp);
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
  trajectory.reserve(results_.size());
  for (const FrameResult& result : results_) trajectory.push_back({result.timestamp, result.place.T_wc()});
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
  for (const FrameResult& result : results_) {
    const KeyFrame* reference = result.place.reference;
    if (reference == nullptr || result.tracking.state != TrackingState::tracking) continue;
    while (reference->erased) reference = reference->stand_in;
    SubmapSummary& submap = submaps[reference->submap];
    if (submap.frames++ == 0) submap.first_frame = result.index;
    submap.last_frame = result.index;
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
