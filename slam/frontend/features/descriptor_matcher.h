// Matches descriptors without knowing where to look: every one against every other.
//
// a matches b if b is the nearest of a and a the nearest of b (Hamming distance d1), d1 <= max_distance and
// d1 <= ratio * d2 with d2 the distance of a's second nearest. Cost: |a| * |b| distances, about 3 ms for
// 2000 x 2000.
#pragma once

#include <span>
#include <vector>

#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/frame_matcher.h"

namespace penumbra::slam {

struct DescriptorMatcherSettings {
  int max_distance = 64;
  float ratio = 0.8F;
};

// Match::source is the index in `a`, Match::feature the index in `b`; in the order of `a`.
std::vector<Match> match_descriptors(std::span<const Descriptor> a, std::span<const Descriptor> b,
                                     const DescriptorMatcherSettings& settings);

}  // namespace penumbra::slam
