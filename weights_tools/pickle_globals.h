// What the Python globals in a checkpoint stand for.
//
// Nothing is ever imported or called, so every class and function may be named; most are records, of which
// only the attributes are kept. Functions that no checkpoint needs and that would run code, load files or
// reach the network when Python reads the file end the reading: whoever made the file wanted that to happen.
#pragma once

#include <optional>
#include <string_view>

#include "weights_tools/pickle_value.h"

namespace penumbra::weights_tools {

// What `module.name` stands for, or nothing where it is refused.
std::optional<Global> find_global(std::string_view module, std::string_view name);

// Why a global is refused, and what the user can do about it.
std::string_view advice_on_refused_global(std::string_view module, std::string_view name);

}  // namespace penumbra::weights_tools
