// The allow-list of Python globals in checkpoints.
#pragma once

#include <optional>
#include <string_view>

#include "weights_tools/pickle_value.h"

namespace penumbra::weights_tools {

// What `module.name` stands for, or nothing where it is not on the list.
std::optional<Global> find_global(std::string_view module, std::string_view name);

// What the user can do about a global that is not on the list, by the look of it.
std::string_view advice_on_refused_global(std::string_view module, std::string_view name);

}  // namespace penumbra::weights_tools
