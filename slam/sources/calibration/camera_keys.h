// The keys of a calibration.yaml and the names that others give them; docs/datasets.md has the table.
#pragma once

#include "slam/sources/calibration/yaml_file.h"

namespace penumbra::slam {

// Gives every key its own name; throws InputError as use_known_keys does.
void use_camera_keys(YamlFile& yaml);

}  // namespace penumbra::slam
