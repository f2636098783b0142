// The keys that a YAML file may hold, under all the names that tools of the field give them. A key that is
// not known is an error: left unread it would change the result without a word, as a lens's distortion would.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slam/sources/calibration/yaml_file.h"

namespace penumbra::slam {

struct KnownKey {
  std::string name;                         // as the reader asks for it
  std::vector<std::string_view> spellings;  // others; capitals and small letters, '-' and '_' are the same
};

// Gives every key of `yaml` its known name. A key "a.data" beside "a.rows", "a.cols" and "a.dt", as OpenCV
// and ROS write matrices, is the key "a". Throws InputError (file:line) for a key that is not known, naming
// the nearest that is, and for two spellings of one key.
void use_known_keys(YamlFile& yaml, std::span<const KnownKey> known);

}  // namespace penumbra::slam
