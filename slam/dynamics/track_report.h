// What is told of the objects that are followed: to the map, to pictures and reports, and to whoever asks how
// much of the image moves.
//
// Positions are metres in the camera's frame of the frame that they belong to. Cost: the objects times the
// frames that are kept of each, and for moving_share() the pixels of their masks.
#pragma once

#include <vector>

#include "slam/dynamics/dynamics.h"
#include "slam/dynamics/frame_history.h"
#include "slam/dynamics/motion_belief.h"
#include "slam/dynamics/track.h"

namespace penumbra::slam {

// What frame `frame` shows, in the order of `tracks`; keyframes know an object as its id + `first_number`.
std::vector<SeenObject> seen_objects(const std::vector<Track>& tracks, int frame, const MotionBelief& belief,
                                     int first_number);

// The objects of the keyframes in `history`, for those keyframes where they are not what was told last. They
// count as told after that (FrameRecord::told).
std::vector<KeyframeObjects> tell_keyframe_objects(FrameHistory& history, const std::vector<Track>& tracks,
                                                   const MotionBelief& belief, int first_number);

// What frame `frame` shows, with masks.
std::vector<InstanceSighting> sightings_in(const std::vector<Track>& tracks, int frame);

// Share of an image of width x height that the newest views of moving objects cover, 0..1. `proven`: of those
// only whose motion there is evidence of.
double moving_share(const std::vector<Track>& tracks, int width, int height, bool proven);

}  // namespace penumbra::slam
