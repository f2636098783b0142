// Notices a stereo pair whose images are exchanged, or whose baseline has the wrong sign: the same thing.
//
// A point stands further left in the right camera's image: its disparity is positive. Matched the wrong way
// round hardly any feature finds a partner, and what does are accidents. So the first frames are looked at:
// where few features have a match as the images are given, and several times as many with the images
// exchanged, and this in kVotes frames, the order is wrong. Frames that settle nothing (black, blank, nothing
// but far away) are passed over. Costs a second stereo match in the few frames that look bad, and nothing
// after the first good one.
#pragma once

#include "slam/frontend/features/stereo_matcher.h"

namespace penumbra::slam {

class StereoOrder {
 public:
  // `matches`: of the pair as it is given, which is frame `index`. Throws InputError once it is sure that the
  // images are exchanged.
  void check(int index, const StereoCamera& camera, const Features& left, const Features& right,
             const ImagePyramid& left_pyramid, const ImagePyramid& right_pyramid,
             const StereoMatches& matches);

 private:
  static constexpr int kVotes = 3;
  bool settled_ = false;
  int votes_ = 0;
};

}  // namespace penumbra::slam
