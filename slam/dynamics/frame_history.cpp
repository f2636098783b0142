#include "slam/dynamics/frame_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace penumbra::slam {

namespace {

constexpr double kFrameSeconds = 0.1;  // where the times do not say

}  // namespace

void FrameHistory::begin(int index, double time, std::shared_ptr<const FrameFeatures> features,
                         const SE3& T_step) {
  FrameRecord now;
  now.index = index;
  now.time = usable_time(time, index);
  now.movable.assign(static_cast<std::size_t>(features->size()), 0);
  now.features = std::move(features);
  if (!records_.empty()) now.T_co = T_step * records_.back().T_co;
  records_.push_back(std::move(now));
  if (static_cast<int>(records_.size()) > most_) records_.pop_front();
}

void FrameHistory::locate(const SE3& T_step, bool reliable, std::shared_ptr<const FeaturePixels> pixels,
                          const std::vector<char>& movable) {
  FrameRecord& now = newest();
  now.pixels = std::move(pixels);
  now.standing.assign(movable.size(), 0);
  for (std::size_t i = 0; i < movable.size(); ++i) now.standing[i] = now.movable[i] != 0 && movable[i] == 0;
  now.movable = movable;
  now.reliable = reliable;
  now.observed = true;
  if (records_.size() >= 2) now.T_co = T_step * before_newest().T_co;
}

FrameRecord* FrameHistory::find(int index) {
  const auto at =
      std::find_if(records_.begin(), records_.end(), [&](const FrameRecord& r) { return r.index == index; });
  return at == records_.end() ? nullptr : &*at;
}

const FrameRecord* FrameHistory::find(int index) const {
  const auto at =
      std::find_if(records_.begin(), records_.end(), [&](const FrameRecord& r) { return r.index == index; });
  return at == records_.end() ? nullptr : &*at;
}

double usable_time(double time, int index) { return std::isfinite(time) ? time : kFrameSeconds * index; }

double seconds_between(const FrameRecord& from, const FrameRecord& to) {
  const double seconds = to.time - from.time;
  const int frames = to.index - from.index;
  return seconds * frames > 0.0 ? seconds : kFrameSeconds * frames;
}

}  // namespace penumbra::slam
