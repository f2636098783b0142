// How alike two images are, by their landmarks.
//
// Landmarks a_i and b_j may be the same thing where their classes are the same. Their likeness is the cosine
// of their descriptors, of which c_0 and less say nothing:
//
//   l_ij = max(0, (d_i . d_j - c_0) / (1 - c_0))
//
// Each landmark is paired with one of the other image at most, the most alike pairs first. With interests I,
//
//   S(A, B) = sum over pairs of sqrt(I_i I_j) l_ij  /  (1/2 (sum I_i + sum I_j))          in [0, 1]
//
// S(A, A) = 1; a landmark without a partner lowers S by its interest; S is symmetric. Two images without
// landmarks have S = 0: nothing says that they show the same place.
//
// Cost: about 2 us for 24 landmarks each, no allocation. Landmarks beyond the first kMostLandmarks do not
// count.
#pragma once

#include "slam/brain/landmarks/landmark.h"

namespace penumbra::slam::brain {

struct SimilaritySettings {
  float least_cosine = 0.6F;  // c_0
  bool interest = true;       // false: every landmark counts 1
};

double similarity(const Landmarks& a, const Landmarks& b, const SimilaritySettings& settings = {});

}  // namespace penumbra::slam::brain
