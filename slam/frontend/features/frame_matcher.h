// Matches known 3-D points to the features of a frame, guided by where a pose prediction projects them.
//
// For every projection: among the features in a square window around it (half width radius * scale of the
// projection's level) on a neighbouring level, the one with the smallest Hamming distance d1 if
//   d1 <= max_distance   and   d1 <= ratio * d2     (d2: second best; only where it is on the same level)
// Cross check: of several projections that choose one feature, the one with the smallest distance keeps it.
// Rotation check: the differences of orientation are put into 30 bins; pairs outside the three fullest bins
// (of which the second and third must reach a tenth of the first) are removed: an image turns as a whole.
//
// Source: the guided search of ORB-SLAM (T-RO 2015), sections V-B and V-D; ratio test: Lowe (IJCV 2004).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/frontend/features/feature_view.h"

namespace penumbra::slam {

// Where a known point should be seen.
struct Projection {
  float u = 0.0F, v = 0.0F;  // pixels
  float u_right = -1.0F;     // predicted column in the right image; negative: do not compare it
  int level = 0;             // level on which the point should be found
  float angle = 0.0F;        // orientation it had when it was last seen, radians
  const Descriptor* descriptor = nullptr;
  int source = 0;  // the caller's number of the point
};

struct Match {
  int source = 0;    // Projection::source
  int feature = 0;   // feature of the frame
  int distance = 0;  // Hamming
};

struct FrameMatcherSettings {
  float radius = 15.0F;  // pixels at level 0
  int max_distance = 100;
  float ratio = 0.9F;
  bool check_rotation = true;
  int levels_below = 1, levels_above = 1;  // neighbouring levels that are searched
};

// `scales`: level_scales of the pyramid. `taken`: features that are not to be matched (may be empty).
// Features on what moves are never matched. Matches come in the order of `projections`.
std::vector<Match> match_projections(std::span<const Projection> projections, const FeatureView& frame,
                                     std::span<const char> taken, std::span<const double> scales,
                                     const FrameMatcherSettings& settings);

}  // namespace penumbra::slam
