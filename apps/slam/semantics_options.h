// The options of `penumbra slam` that say what is left out because it moves.
#pragma once

#include <string>

#include "apps/slam/slam_run.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

// Whether an option counts: defaults of the command line do not undo what the file of settings says.
bool has_a_say(const SlamOptions& options, const char* name);

// --segmentation, --dynamics and what belongs to it, --static-points, --moving. With boxes, and where points
// that stand are given back one by one, the class of a thing decides whether it moves, as in the papers,
// unless --moving says otherwise. UsageError as set_segmentation().
void set_semantics(const SlamOptions& options, slam::SemanticsSettings& semantics);

// Which frames `text`, as --segmentation takes it, says. Throws UsageError where it says none.
void set_segmentation(const std::string& text, slam::SemanticsSettings& semantics);

// Throws UsageError where --dynamics lacks what it needs.
void check_semantics(const SlamOptions& options, const slam::StereoDataset& dataset,
                     const slam::SemanticsSettings& semantics);

// As --segmentation takes it.
std::string segmentation_text(const slam::SemanticsSettings& semantics);

}  // namespace penumbra::apps
