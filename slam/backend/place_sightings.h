// Keyframes that were verified at older places, and whether they agree: where a place is what it seems, the
// poses that several keyframes find there relate to each other as odometry says they do.
//
// Their views must be independent: a camera that stands sees the same wrong place again and again, one that
// has gone on or has turned elsewhere sees other points.
#pragma once

#include <deque>
#include <functional>

#include "slam/map/map.h"
#include "slam/place/place_verifier.h"

namespace penumbra::slam {

struct PlaceAgreementSettings {
  int consistent = 3;         // verified keyframes that must agree ...
  int window = 10;            // ... among this many
  double agree_metres = 0.5;  // how far two of them may differ, plus 5 % of the way between them
  double agree_radians = 0.035;
  // Two of them have independent views: so far apart, or looking so far in another direction.
  double least_motion_baselines = 2.0;
  double least_turn = 0.15;  // radians
};

// A keyframe that was verified against an older one: its pose there.
struct PlaceSighting {
  const KeyFrame* keyframe = nullptr;
  SE3 T_cw;
};

class PlaceSightings {
 public:
  // `baseline`: metres.
  PlaceSightings(const PlaceAgreementSettings& settings, double baseline)
      : settings_(settings), baseline_(baseline) {}

  // Forgets those more than a window of keyframes before `newest`.
  void forget_before(const KeyFrame& newest);
  void add(const PlaceSighting& sighting) { sightings_.push_back(sighting); }
  void clear() { sightings_.clear(); }
  // Whether enough of the earlier ones, of the same sub-map, agree with it.
  bool agree_with(const PlaceSighting& newest) const;

 private:
  bool agree(const PlaceSighting& a, const PlaceSighting& b) const;
  bool are_independent(const PlaceSighting& a, const PlaceSighting& b) const;

  const PlaceAgreementSettings settings_;
  const double baseline_;
  std::deque<PlaceSighting> sightings_;
};

// Of the place's keyframe and those covisible with it the one nearest to where the keyframe was taken, at
// most `distance` metres and `turn` radians away, that `counts`; nullptr where there is none.
KeyFrame* nearest_keyframe(const VerifiedPlace& place, double distance, double turn,
                           const std::function<bool(const KeyFrame&)>& counts);

}  // namespace penumbra::slam
