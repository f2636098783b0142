// Pictures of the keyframes with their features, for people to look at.
#pragma once

#include <filesystem>
#include <map>

#include "slam/pipeline/recorder.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

// Writes at most `most` keyframes, evenly spread over the run, as folder/NNNNNN.jpg (NNNNNN: the frame), as
// apps/view/frame_picture.h draws them. What an earlier run left in `folder` is removed first. Frames that
// can no longer be read are left out.
void write_keyframe_gallery(const std::filesystem::path& folder, const slam::StereoDataset& dataset,
                            const slam::Recorder& record, int most = 60);

// Those that are in `folder`, which need not exist, by their frames.
std::map<int, std::filesystem::path> gallery_pictures(const std::filesystem::path& folder);

// Removes such pictures, and nothing else, from `folder`, which need not exist.
void clear_keyframe_gallery(const std::filesystem::path& folder);

}  // namespace penumbra::apps
