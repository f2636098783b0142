// What a run keeps of each frame, for reports and trajectories.
//
// A frame's place is kept relative to a keyframe, so that corrections of the map since then move it, too.
// Frames and the bars of their histograms lie in files without a name (nn/base/spool.h), 0.2 kB a frame each:
// memory does not grow with them.
//
// A copy holds the frames so far: another thread may write them while the run goes on.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "nn/base/spool.h"
#include "slam/geometry/trajectory.h"
#include "slam/pipeline/slam.h"

namespace penumbra::slam {

// What is kept of a FrameResult.
struct KeptFrame {
  double timestamp = 0.0;                  // seconds
  double milliseconds = 0.0;               // that it took
  double covered_share = 0.0;              // of the image, by what moves
  const KeyFrame* reference = nullptr;     // FramePlace, in plain numbers
  std::array<double, 12> T_c_reference{};  // rotation by columns, translation
  std::uint64_t first_bar = 0;             // of the mismatch filter's histogram, among those of all frames
  double bar_from = 0.0, bar_width = 0.0;  // pixels
  int index = 0;
  int features = 0, stereo_features = 0, movable_features = 0;
  int frame_matches = 0, map_inliers = 0;
  int bars = 0, filter_kept = 0, filter_removed = 0;
  StaticPointCount static_points;
  TrackingState state = TrackingState::initialising;
  bool keyframe = false, starts_submap = false;

  FramePlace place() const;
  bool is_located() const { return state == TrackingState::tracking; }
};

// A bar of a frame's histogram.
struct FilterBar {
  int kept = 0, removed = 0;
};

class KeptFrames {
 public:
  // `map`: in which the frames have their places; it must live longer.
  KeptFrames(const Map& map, const std::filesystem::path& folder)
      : map_(&map), frames_(folder), bars_(folder) {}

  void add(const FrameResult& result);

  const Spool<KeptFrame>& frames() const { return frames_; }
  std::vector<FilterBar> bars(const KeptFrame& frame) const;

  // T_wc of frames as one moment's map has them. A lost frame has the pose that was predicted for it.
  class Poses {
   public:
    SE3 of(const KeptFrame& frame) const;

   private:
    friend class KeptFrames;
    std::unordered_map<const KeyFrame*, SE3> T_reference_w_;
  };
  // As the map is now, whose lock it holds meanwhile.
  Poses poses() const;
  Trajectory trajectory() const;

 private:
  const Map* map_;
  Spool<KeptFrame> frames_;
  Spool<FilterBar> bars_;
  std::unordered_set<const KeyFrame*> references_;
};

}  // namespace penumbra::slam
