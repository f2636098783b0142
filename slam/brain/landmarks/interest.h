// The interest of landmarks: a rare one says where the camera is, one of a row of equal ones hardly does.
//
//   I_i = s_i / n_i^r                                                       docs/papers.md D.2 (16, 17)
//
// s_i is the score of the region, n_i the number of the image's regions of the same class. The paper gives
// no formula, only that interest falls with n: r = 1 makes all classes of an image weigh about the same.
//
// Two regions of different classes may be one landmark, as a sign and the lamp post that carries it:
// small ones that touch join if asked for. The joint landmark has the class of the one that is the more
// interesting, the box of both, and the descriptor  I_1 d_1 + I_2 d_2,  made unit length.
//
// Cost: microseconds.
#pragma once

#include "slam/brain/landmarks/landmark.h"

namespace penumbra::slam::brain {

struct InterestSettings {
  double rarity = 0.5;              // r
  bool join = false;                // touching regions
  float join_largest_side = 60.0F;  // pixels of a region that joins
  float join_gap = 1.0F;            // pixels between regions that touch
};

// Gives the landmarks of an image their interest, joins those that touch, sorts them by interest and drops
// what is beyond kMostLandmarks.
void rate(Landmarks& landmarks, const InterestSettings& settings = {});

}  // namespace penumbra::slam::brain
