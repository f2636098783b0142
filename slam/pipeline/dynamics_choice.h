// The ways to leave out what moves, by the names that people choose them by:
//
//   masks            of the network                        geometry decides what moves
//   boxes            all that is in a box                  from here on the class decides, as in the papers
//   depth-clusters   of boxes and depth                    needs depth
//   static-points    of boxes and the features' depths;    needs depth
//                    what stands is given back point by point
#pragma once

#include <string_view>

#include "slam/pipeline/slam_settings.h"

namespace penumbra::slam {

// Sets how masks are made, and whether points are given back: with static-points as `settings` says already,
// or by the paper's letter. False, and nothing, for another name.
bool choose_dynamics(std::string_view name, SemanticsSettings& settings);

// Whether an object's class decides if it moves, where nobody says otherwise (InstanceTrackerSettings).
bool class_decides(const SemanticsSettings& settings);

bool needs_depth(InstanceMasks masks);

}  // namespace penumbra::slam
