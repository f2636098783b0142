// Whether a thing that one view shows is elsewhere in other views: a chair that was pushed, a box that was
// carried. Its class does not tell, and most of its voxels may be seen by one view alone.
//
// Of every few pixels of its mask the place p in space is looked up in another view, at depth z(p):
//
//   same      the depth there is z(p), but for   3 sigma(z) + 2 voxels
//   through   that depth and those around it are all behind p by more than that
//
// and else the place is hidden, outside, or without depth. A view contradicts where at least half of what it
// tells, and `kFewestTold` places, are seen through; it confirms where more than half, and so many, are the
// same. A thing that two views contradict is elsewhere in them: by then, or before. One that no view confirms
// was in passing, where there are other views at all.
//
// Cost: about 20 ns a pixel and view.
#pragma once

#include <span>

#include "slam/map/dense/fusion.h"

namespace penumbra::slam {

// `region`, `mask`: as set_label() takes them, in the view `from`, one of the views; `step`: of the views.
bool is_displaced(const PosedView& from, int step, const Rect& region, const ByteImage& mask,
                  std::span<const PosedView> views, const FusionSettings& settings);

}  // namespace penumbra::slam
