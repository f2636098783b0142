// Whether a thing that one view shows is elsewhere in other views: a chair that was pushed, a box that was
// carried. Its class does not tell, and most of its voxels may be seen by one view alone.
//
// Of every few pixels of its mask the place p in space is looked up in another view, at depth z(p):
//
//   same      the depth there is z(p), but for   3 sigma(z) + 2 voxels
//   through   that depth and those around it are all behind p by more than that
//
// and else the place is hidden, outside, or without depth. A view looks at the thing where `kFewestTold`
// places are one or the other. It contradicts where at least half of these, and so many, are seen through;
// it confirms where more than half, and so many, are the same. A thing that two views contradict is
// elsewhere in them: by then, or before. One that no view confirms, of those that look, was in passing.
// Views that look away, or in which something stands before it, say nothing.
//
// At most `kMostAsked` views are asked about a thing, spread evenly over those that have it before them, so
// that the cost grows with the number of views and not with its square. Cost: 20 ns a place and view that is
// asked, and 1 ms a view and thread. Deterministic.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "slam/map/dense/fusion.h"

namespace penumbra::slam {

// A thing in one of the views; `region`, `mask`: as set_label() takes them.
struct ShownThing {
  std::size_t view = 0;  // its number
  Rect region;
  const ByteImage* mask = nullptr;
};

// 1 for each thing that is elsewhere in other views.
std::vector<char> find_displaced(std::span<const ShownThing> things, std::span<const PosedView> views,
                                 const FusionSettings& settings);

}  // namespace penumbra::slam
