// Keeps what a run has found, frame by frame, for reports and trajectories: Slam itself keeps nothing that
// grows with the number of frames.
//
//   Slam slam(camera, sensor, settings);
//   Recorder record(slam);
//   for each frame:  record.add(slam.process(images));
//   record.finish();                                     Slam::finish(), and what it still found
//
// What it keeps of each frame: slam/pipeline/kept_frames.h. The thread that calls Slam::process() uses it.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "nn/base/samples.h"
#include "slam/geometry/trajectory.h"
#include "slam/pipeline/kept_frames.h"
#include "slam/pipeline/slam.h"

namespace penumbra::slam {

// A piece of the map whose keyframes are tied to each other. One is all there should be; a further one begins
// where the way was lost and nothing was recognised, and ends to be one when a loop ties it to an older one.
// A piece that is never tied keeps the pose that was guessed for its beginning.
struct SubmapSummary {
  int submap = 0;                       // its number
  int first_frame = 0, last_frame = 0;  // that were located in it
  int frames = 0, keyframes = 0;
};

class Recorder {
 public:
  // `slam` must live longer. `folder`: where frames are kept while the run goes on; the system's for
  // temporary files unless it is said.
  explicit Recorder(Slam& slam, const std::filesystem::path& folder = {})
      : slam_(slam), frames_(slam.map(), folder) {}

  // What the segmenter sees in the frame is to be kept, some 20 kB (dense_mapper.h); before the frame is
  // added.
  void keep_masks_of(int frame) { with_masks_.insert(frame); }

  // Takes what process() has returned, in the order of the frames; returns it without its findings, until the
  // next one.
  const FrameResult& add(FrameResult result);
  void finish();

  const Slam& slam() const { return slam_; }
  // All that is kept of the frames; a copy of it is for another thread.
  const KeptFrames& kept() const { return frames_; }
  const Spool<KeptFrame>& frames() const { return frames_.frames(); }
  // Of the mismatch filter's histogram; empty where it did not run.
  std::vector<FilterBar> bars(const KeptFrame& frame) const { return frames_.bars(frame); }
  int tracked() const { return tracked_; }
  int lost() const { return static_cast<int>(frames().size()) - tracked_; }
  // Pose of every frame so far, as the map now sees it; a lost frame has the pose that was predicted for it.
  Trajectory trajectory() const { return frames_.trajectory(); }
  // The pieces of the map, in the order of their numbers.
  std::vector<SubmapSummary> submaps() const;
  // All objects that were found, by their numbers.
  std::vector<TrackedInstance> instances() const;
  // What each keyframe showed of them, by its frame's number; the masks are small.
  const std::map<int, std::vector<InstanceSighting>>& sightings() const { return sightings_; }
  // What the segmenter saw in each frame for which that is kept and that it was shown, followed or not; masks
  // of half the size.
  const std::map<int, std::vector<Instance>>& masks() const { return masks_; }
  // Seconds from a frame that the segmenter was shown to the first that knew what it saw.
  const Samples& mask_delays() const { return mask_delays_; }

 private:
  void note_delays(const std::vector<SegmentedFrame>& found);
  void keep(Findings findings);

  Slam& slam_;
  std::set<int> with_masks_;
  KeptFrames frames_;
  FrameResult newest_;
  int tracked_ = 0;
  std::vector<TrackedInstance> gone_;
  std::map<int, std::vector<InstanceSighting>> sightings_;
  std::map<int, std::vector<Instance>> masks_;
  Samples mask_delays_;
};

}  // namespace penumbra::slam
