// The last frames as the tracking of objects knows them: what was measured, where the camera was, and which
// features lie on what moves. A result of the segmenter comes late, and is about one of them.
//
// Poses are those of odometry: every frame is placed relative to the one before, and later corrections of the
// map change nothing here.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/se3.h"
#include "slam/map/keyframe.h"

namespace penumbra::slam {

struct FrameRecord {
  int index = 0;
  double time = 0.0;  // seconds
  std::shared_ptr<const FrameFeatures> features;
  std::shared_ptr<const FeaturePixels> pixels;  // once it was located; may be null
  std::vector<char> movable;                    // per feature
  std::vector<char> standing;                   // per feature: 1 where it was marked, and given back
  SE3 T_co;                                     // camera from odometry
  bool observed = false;                        // T_co is final, not predicted
  bool reliable = true;                         // T_co says how the camera moved
  KeyFrame* keyframe = nullptr;
  std::vector<SeenObject> told;  // what the map knows of the keyframe's objects

  FeatureView view() const { return {*features, pixels, movable}; }
  bool stands(int feature) const {
    return !standing.empty() && standing[static_cast<std::size_t>(feature)] != 0;
  }
};

class FrameHistory {
 public:
  // `most`: frames that are kept.
  explicit FrameHistory(int most) : most_(most) {}

  // Begins a frame, which is `T_step` from the last one as far as that is known.
  void begin(int index, double time, std::shared_ptr<const FrameFeatures> features, const SE3& T_step);
  // The newest frame has been located: `T_step` from the last one.
  void locate(const SE3& T_step, bool reliable, std::shared_ptr<const FeaturePixels> pixels,
              const std::vector<char>& movable);

  // nullptr where it is not known, or not any more.
  const FrameRecord* find(int index) const;
  FrameRecord* find(int index);

  bool empty() const { return records_.empty(); }
  std::size_t size() const { return records_.size(); }
  FrameRecord& newest() { return records_.back(); }
  const FrameRecord& newest() const { return records_.back(); }
  const FrameRecord& before_newest() const { return records_[records_.size() - 2]; }
  const FrameRecord& oldest() const { return records_.front(); }
  // Oldest first.
  std::deque<FrameRecord>& records() { return records_; }
  const std::deque<FrameRecord>& records() const { return records_; }

 private:
  const int most_;
  std::deque<FrameRecord> records_;
};

// A frame's time; one that is no number is taken to be that of ten frames a second.
double usable_time(double time, int index);
// By their times, or where these do not say, by their numbers.
double seconds_between(const FrameRecord& from, const FrameRecord& to);

}  // namespace penumbra::slam
