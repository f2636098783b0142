// frames.json: what happened frame by frame; `penumbra report` draws it.
#pragma once

#include <filesystem>

#include "slam/pipeline/kept_frames.h"

namespace penumbra::apps {

const char* name_of(slam::TrackingState state);

// One array a quantity, one entry a frame: index, timestamp (s), state, ms, features, stereo_features,
// movable_features, matches, inliers, keyframe, and filter: the mismatch filter's histogram as {from, width
// (pixels moved, or from where the compensated filter expects them), kept [a bin], removed [a bin]}, null
// where it did not run or was not kept. Written as it is read: memory does not grow with
// the frames. Whole or not at all; throws Error where it cannot be written.
void write_frames_report(const std::filesystem::path& path, const slam::KeptFrames& run);

}  // namespace penumbra::apps
