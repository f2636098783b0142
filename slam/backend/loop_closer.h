// Recognises places that the camera has seen before and makes the map agree with itself there.
//
//   remember the keyframes that have left the camera's surroundings   (place_index.h)
//   candidates by appearance -> verified by geometry                  (place_verifier.h)
//   consistent with the last keyframes' verifications?
//     -> correct the map, fuse duplicate points                       (map_correction.h)
//
// A false loop ruins a map, a missed one costs a little accuracy until the next chance. So several keyframes
// must be verified one after the other, and must agree (place_sightings.h). The correction must also be one
// that drift can explain, and the place one that had been left before.
//
// process() needs the keyframes in the order in which they leave the local mapper. It locks the map: shared
// while it looks for the place, alone while it corrects. What it does repeats bit for bit. A corrected map
// should be adjusted as a whole (full_bundle_adjustment.h), which the caller does when it has time
// (map_worker.h). Source: Mur-Artal, Tardos, ORB-SLAM2 (T-RO 2017), section III-D; Campos et al., ORB-SLAM3
// (T-RO 2021), section V (sub-maps).
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "slam/backend/map_correction.h"
#include "slam/backend/place_sightings.h"
#include "slam/place/place_index.h"
#include "slam/place/place_verifier.h"

namespace penumbra::slam {

struct LoopCloserSettings : PlaceAgreementSettings {
  bool enabled = true;
  bool corrects = true;  // false: places are recognised, but the map is left as it is
  PlaceVerifierSettings verifier;
  MapCorrectionSettings correction;
  int candidates = 3;  // verified per keyframe
  int age = 5;         // keyframes after which one enters the index
  int fewest_frames_apart = 50;
  // What counts as the same place: as in the evaluation (slam/evaluation/loop_evaluation.h).
  double largest_distance = 5.0;  // metres
  double largest_turn = 0.5236;   // radians
  // A correction beyond drift_metres + drift_share * (way since then) is not drift.
  double drift_metres = 3.0;
  double drift_share = 0.05;
  int pause = 10;  // keyframes after a loop in which no other is closed
};

// A loop that was closed.
struct ClosedLoop {
  int frame = 0, earlier_frame = 0;  // frames of the keyframes that show the same place
  int inliers = 0;                   // points that proved it ...
  int objects = 0;                   // ... and objects, where the points alone had not been enough
  double correction_metres = 0.0;    // how far the keyframe was moved
  bool merged_submaps = false;
  bool of_loaded_map =
      false;  // the earlier keyframe is of a map that was loaded, and its frame of another run
};

// A keyframe that was proven to show an earlier place, whether or not a loop came of it.
struct RecognisedPlace {
  int frame = 0, earlier_frame = 0;  // of the keyframes
  int inliers = 0, objects = 0;      // as in ClosedLoop
  bool of_loaded_map = false;
};

class LoopCloser {
 public:
  // Keyframes enter `index` here, also where loops are not to be closed: who is lost looks there, too.
  LoopCloser(Map& map, PlaceIndex& index, const LoopCloserSettings& settings)
      : map_(map), index_(index), settings_(settings), sightings_(settings, map.camera().baseline) {}

  // The keyframes of a map that was loaded are places of old: to be called before the first process().
  void adopt_map();

  // Takes the next keyframe, in the order in which they are made. Where it closes a loop the map has been
  // corrected on return: poses and points have moved, points were merged.
  std::optional<ClosedLoop> process(KeyFrame* keyframe);

  const std::vector<ClosedLoop>& loops() const { return loops_; }
  const std::vector<RecognisedPlace>& recognised() const { return recognised_; }

 private:
  void measure_way(const KeyFrame* newest);
  void remember_older_keyframes(const KeyFrame* newest);
  std::optional<VerifiedPlace> recognise(const KeyFrame& keyframe) const;
  KeyFrame* revisited(const KeyFrame& keyframe, const VerifiedPlace& place) const;
  bool drift_explains(const KeyFrame& keyframe, const VerifiedPlace& place) const;
  void close(KeyFrame* keyframe, const VerifiedPlace& place);

  Map& map_;
  PlaceIndex& index_;
  const LoopCloserSettings settings_;
  int first_own_ = 0;              // id of the first keyframe that is not of a loaded map
  std::deque<KeyFrame*> waiting_;  // for the index
  std::vector<double> travelled_;  // keyframe id -> metres since the first keyframe
  const KeyFrame* last_keyframe_ = nullptr;
  PlaceSightings sightings_;
  std::vector<LoopEdge> edges_;
  std::vector<ClosedLoop> loops_;
  std::vector<RecognisedPlace> recognised_;
  int last_loop_ = -1000000;  // id of the keyframe that closed it
};

}  // namespace penumbra::slam
