#include "slam/pipeline/recorder.h"

#include <algorithm>
#include <shared_mutex>
#include <utility>

#include "nn/image/resize.h"

namespace penumbra::slam {

const FrameResult& Recorder::add(FrameResult result) {
  Findings findings = std::exchange(result.findings, {});
  result.tracking.mover.reset();  // its mask is large, and no report shows it
  frames_.add(result);
  tracked_ += result.tracking.state == TrackingState::tracking;
  note_delays(findings.segmented);
  keep(std::move(findings));
  newest_ = std::move(result);
  return newest_;
}

// Of what the newest frame was told.
void Recorder::note_delays(const std::vector<SegmentedFrame>& found) {
  for (const SegmentedFrame& seen : found) {
    const double now = frames().back().timestamp;
    for (std::size_t i = frames().size(); i-- > 0;) {
      const KeptFrame shown = frames()[i];
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

std::vector<SubmapSummary> Recorder::submaps() const {
  const std::shared_lock lock(slam_.map().mutex());
  std::map<int, SubmapSummary> submaps;
  for (const KeyFrame* keyframe : slam_.map().keyframes()) {
    SubmapSummary& submap = submaps[keyframe->submap];
    submap.submap = keyframe->submap;
    ++submap.keyframes;
  }
  for (const KeptFrame& frame : frames()) {
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
