// Whether a cognitive map of an earlier run can be gone on with.
#pragma once

#include <string>

#include "slam/brain/brain_settings.h"
#include "slam/brain/map/map_file.h"

namespace penumbra::slam::brain {

// Throws InputError, naming `place`, for a map of another camera, of one that is turned another way on the
// robot, or with other templates.
void require_fitting(const StoredMap& stored, const StereoCamera& camera, const BrainSettings& settings,
                     const std::string& place);

}  // namespace penumbra::slam::brain
