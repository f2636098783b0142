// How well a run found the places that it came to twice.
//
// Two frames show the same place where their true positions are at most `largest_distance` apart and their
// headings at most `largest_turn`. Frame i is a revisit where it shows the same place as an earlier frame j
// with i - j >= fewest_frames_apart, and the camera was away in between: the way from j to i is longer than
// twice `largest_distance` (a car that waits at a light revisits nothing). Revisits in a row, gaps below
// `fewest_frames_apart` bridged, make a region: a stretch of the way that is driven again.
//
//   precision of the loops   = loops whose two frames show the same place, at least fewest_frames_apart apart
//                              / loops closed
//   recall of the regions    = regions in which such a loop was closed / regions
//   recall of the keyframes  = revisits among the keyframes that the finished map ties to an earlier visit
//                              (they share points with a keyframe at least fewest_frames_apart before)
//                              / revisits among the keyframes
//
// The last says whether the map knows that both visits saw the same things, which is what a loop is for:
// within a region that is closed, one loop is enough to make every further keyframe see the old points. Cost:
// O(n^2) distances for n frames, 0.1 s for 5000.
#pragma once

#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam {

struct RevisitSettings {
  double largest_distance = 5.0;   // metres
  double largest_turn = 0.523599;  // radians
  int fewest_frames_apart = 50;
};

bool is_same_place(const SE3& T_wa, const SE3& T_wb, const RevisitSettings& settings);

// Per frame: the nearest earlier frame that it revisits; -1 where it revisits none.
std::vector<int> find_revisits(const Trajectory& truth, const RevisitSettings& settings = {});

// Frames `begin` to `end` - 1 go where earlier ones, among them `earlier` (what `begin` revisits), went.
struct RevisitRegion {
  int begin = 0, end = 0, earlier = 0;
  bool closed = false;
};
std::vector<RevisitRegion> find_regions(const std::vector<int>& revisits,
                                        const RevisitSettings& settings = {});

// Two frames, the later one first.
struct FramePair {
  int frame = 0, earlier = 0;
};

struct LoopEvaluation {
  struct Loop {
    FramePair frames;
    double distance = 0.0, turn = 0.0;  // true ones, metres and radians
    bool correct = false;
  };
  std::vector<Loop> loops;
  std::vector<RevisitRegion> regions;
  int revisited_keyframes = 0, tied_keyframes = 0;

  int correct_loops() const;
  int closed_regions() const;
  // 1 where there was nothing to find.
  double precision() const;
  double region_recall() const;
  double keyframe_recall() const;
};

// `truth`: the true pose of every frame. `keyframes`: frames of the finished map's keyframes; `covisible`:
// pairs of them that share points. Throws InputError for a frame that is not in `truth`.
LoopEvaluation evaluate_loops(const Trajectory& truth, const std::vector<FramePair>& loops,
                              const std::vector<int>& keyframes, const std::vector<FramePair>& covisible,
                              const RevisitSettings& settings = {});

// Keyframes that a run proved to show an earlier place, whether or not it closed a loop there:
//   precision = those where it is the same place, at least fewest_frames_apart before / all of them
//   recall    = revisits among the keyframes that were so proven / revisits among the keyframes
struct RecognitionEvaluation {
  int places = 0, right_places = 0;
  int revisited_keyframes = 0, recognised_keyframes = 0;

  double precision() const;
  double recall() const;
};
RecognitionEvaluation evaluate_recognition(const Trajectory& truth, const std::vector<FramePair>& recognised,
                                           const std::vector<int>& keyframes,
                                           const RevisitSettings& settings = {});

}  // namespace penumbra::slam
