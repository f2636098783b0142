// Which of the known objects an instance shows.
//
// What can move by its class and what cannot are two things, however their masks overlap: who walks past a
// chair is not the chair. What is near and what is far are two things, unless their masks are nearly the
// same: far depths are uncertain. By overlap of their masks in the instance's frame; else, with the same
// class, by how much of the smaller one the other contains, or by how close their places in space are. What
// is out of sight is compared with where it stood when it was last seen.
//
// Of what fills the view a detector gives several masks, each of another part, and cuts it anew from frame
// to frame. So what shows no known object may be a part of one that moves.
#pragma once

#include <vector>

#include "slam/dynamics/frame_history.h"
#include "slam/dynamics/instance.h"
#include "slam/dynamics/instance_tracker_settings.h"
#include "slam/dynamics/track.h"

namespace penumbra::slam {

// The place in `tracks` of the one that `instance`, seen as `view`, shows; -1 for none that is known.
// `taken`, per track: those that others of the same frame show already.
int owner_of(const Instance& instance, const InstanceView& view, const std::vector<Track>& tracks,
             const std::vector<char>& taken, const FrameHistory& history,
             const InstanceTrackerSettings& settings);

// The object that `part` is a part of: it is known to move by evidence of its own, its depths meet the
// part's, its mask is no smaller, and `part` lies in it (least_containment) or beside it (nearest_metres,
// where both are vehicles or of one class). `part` can move by its class. nullptr for none, and
// where classes decide what moves.
const Track* whole_of(const Instance& part, const InstanceView& view, const std::vector<Track>& tracks,
                      const InstanceTrackerSettings& settings);

}  // namespace penumbra::slam
