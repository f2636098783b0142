// Builds the map beside the tracker: takes keyframes in order, maps them, closes loops, adjusts the whole
// map.
//
//   keyframe -> into the map, with its stereo points                    the tracker's thread
//            -> queue -> [ local mapper -> loop closer ]                the worker's thread
//                 loop closed or map doubled -> [ full bundle adjustment ]   a third thread,
//                                               applied by the worker between two keyframes
//
// A map is doubled when it has 15 keyframes, and again whenever it has twice as many as at its last
// adjustment: so the disparity offset (slam/geometry/stereo_camera.h) is found early, and ever more closely.
//
// In line (threaded = false) everything is done before submit() returns, in the caller's thread: results
// repeat bit for bit. Threaded, the tracker has the new points at once, as in line, and waits only while the
// worker holds Map::mutex() alone: to add points and to take over what an adjustment has found, never while
// one is computed. Where keyframes come faster than the worker can follow, it first ends its local bundle
// adjustments early (kHurry), and then the tracker waits before it adds one more (kLongestQueue), for
// kLongestPause at most. The tracker only adds to the map; the worker alone erases, so what it holds stays
// valid while it has let go of the lock.
//
// What turns out to lie on something that moves, some keyframes later, comes the same way and leaves the map;
// and so do the objects that keyframes show, which stay with them.
//
// A full bundle adjustment is stopped when another loop closes, and begun anew on the map as it is then. At
// the end of a run it is waited for, but no longer than kLongestWait: then it is stopped and what it has
// reached is taken over.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "nn/base/stage_timer.h"
#include "slam/backend/full_bundle_adjustment.h"
#include "slam/backend/local_mapper.h"
#include "slam/backend/loop_closer.h"
#include "slam/dynamics/dynamics.h"

namespace penumbra::slam {

// A keyframe on its way into the map; or none, and what is to be changed in those that are there.
struct MapWork {
  std::unique_ptr<KeyFrame> keyframe;
  std::vector<MapPoint*> tracked;  // per feature: the point that the tracker found there, or nullptr
  std::vector<char> aligned;       // per feature: whether the point's patch was, too
  // What its pose was found against. Where that has been moved meanwhile, by a loop, the keyframe follows.
  const KeyFrame* reference = nullptr;  // nullptr for none
  SE3 reference_T_cw;
  MapEdits edits;  // of keyframes in the map or of this one
};

class MapWorker {
 public:
  MapWorker(Map& map, LocalMapper& mapper, LoopCloser& loop_closer, const FullBundleSettings& full_bundle,
            bool threaded);
  // Drops what is still waiting.
  ~MapWorker();
  MapWorker(const MapWorker&) = delete;
  MapWorker& operator=(const MapWorker&) = delete;

  // On return the keyframe is in the map. Rethrows what an earlier keyframe's work has thrown.
  void submit(MapWork work);
  // Waits until every keyframe is mapped and the whole map adjusted.
  void finish();

  // The times of the stages so far, which are then forgotten. Only after finish().
  StageTimer take_times();

 private:
  // What waits for the worker: a keyframe to map, or changes of others.
  struct Task {
    KeyFrame* keyframe = nullptr;
    MapEdits edits;
  };

  static constexpr std::ptrdiff_t kHurry = 1, kLongestQueue = 3;  // keyframes that wait
  static constexpr std::size_t kFirstDue = 15;                    // keyframes
  static constexpr std::chrono::milliseconds kLongestPause{50};
  static constexpr std::chrono::seconds kLongestWait{20};

  void run();
  std::ptrdiff_t waiting_keyframes() const;
  KeyFrame* insert(MapWork work);
  void process(const Task& task);
  void take_out(const std::vector<MovingFeatures>& moving);
  void note(const std::vector<KeyframeObjects>& objects);
  void collect_erased();
  bool whole_map_is_due() const;
  void adjust_whole_map(int submap);
  void apply_adjustment();
  void stop_adjustment();

  Map& map_;
  LocalMapper& mapper_;
  LoopCloser& loop_closer_;
  const FullBundleSettings full_bundle_;
  const bool threaded_;
  // Of the worker's thread, of the caller's, and of the one that adjusts the whole map.
  StageTimer timer_{"mapping"}, insertion_timer_, adjustment_timer_{"whole map"};

  mutable std::mutex mutex_;         // of what follows
  std::condition_variable changed_;  // of any of it
  std::deque<Task> queue_;
  std::atomic<bool> hurry_{false};  // keyframes wait
  bool working_ = false, adjusting_ = false, ending_ = false;
  std::exception_ptr failure_;

  // The adjustment under way; owned by the worker's thread.
  std::unique_ptr<FullBundleAdjustment> adjustment_;
  std::size_t due_keyframes_;  // with so many keyframes the whole map is adjusted again
  std::atomic<bool> stop_adjustment_{false};
  bool adjusted_ = false;  // guarded by mutex_: the adjustment can be applied
  std::thread adjuster_, thread_;
};

}  // namespace penumbra::slam
