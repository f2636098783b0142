// Whether the things that stand around two keyframes stand alike: evidence for a place beside its
// descriptors, which an occluder, another light or another season take away.
//
// Around a keyframe are the objects that it shows and those that only its neighbours show. Given the motion T
// from the place's camera frame to the image's, object a of the image agrees with object b of the place where
//
//   class a = class b,   |x_a - T x_b| <= 1 m + 5 % of |x_a|        one to one, the nearest pairs first
//
// Only what is proven to stand takes part: a car that may drive away says nothing about a place. Number n of
// agreeing objects alone proves little, since parked cars stand in rows that agree with themselves moved on
// by one car. So the same is counted for every other motion that takes some object of the place onto one of
// the image's class, T moved by t = x_a - T x_b:
//
//   rival = max over t of the number that agree        t: farther than twice what is tolerated
//
// and what was built to be found in two places at once has rival ~ n. The agreeing objects must not stand
// on a line either, along which a shift is least noticed: their root mean square distance from their best
// line in the ground plane is `spread`. Contradicted is an object of the place that the image should show,
// near enough, not at its rim, hidden by nothing, while nothing at all was found there.
//
// Cost: O(n^4) for n objects of a class, seldom more than 10. Source: constellations as landmarks, Frey,
// Steiner, How, Efficient Constellation-Based Map-Merging for Semantic SLAM (ICRA 2019); one-to-one gated
// association as in Bowman et al., Probabilistic Data Association for Semantic SLAM (ICRA 2017).
#pragma once

#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/keyframe.h"

namespace penumbra::slam {

struct ConstellationSettings {
  bool enabled = true;
  int neighbours = 10;  // covisible keyframes whose objects count, too
  double tolerance_metres = 1.0, tolerance_share = 0.05;
  // What supports a place: at least so many agree, that many more than under any other motion, spread ...
  int fewest_agreeing = 3;
  int fewest_more_than_rival = 2;
  double least_spread = 1.0;  // metres
  // ... and at most this share of theirs is contradicted.
  double most_contradicted = 0.5;
  // Where an object of the place should be seen: depths in metres, pixels from the image's rim.
  double nearest = 2.0, farthest = 20.0;
  double rim = 20.0;
};

// Objects in one camera's frame; `region` is empty where that camera itself does not show them.
using Constellation = std::vector<SeenObject>;

// The objects around a keyframe, each once, by their numbers: where the keyframe shows it, otherwise in the
// mean of where its neighbours do. Needs the map's lock shared.
Constellation constellation_around(const KeyFrame& keyframe, int neighbours);

// How many of them stand.
int count_standing(const Constellation& constellation);

struct ConstellationAgreement {
  int agreeing = 0, rival = 0, contradicted = 0;
  double spread = 0.0;  // metres
};

// Objects with the same number in both were followed from one to the other: they say nothing and are left
// out, as are positions that are not finite.
ConstellationAgreement compare_constellations(const StereoCamera& camera, const Constellation& image,
                                              const Constellation& place, const SE3& T_image_place,
                                              const ConstellationSettings& settings);

// Whether that much agreement supports a place.
bool supports_place(const ConstellationAgreement& agreement, const ConstellationSettings& settings);

}  // namespace penumbra::slam
