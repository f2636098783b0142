// Which Python globals would run programs or code, change files, load further pickles or reach the network,
// and so have no place in a checkpoint. What is harmless in such modules is listed in pickle_globals.cpp,
// which asks its own list first.
#pragma once

#include <string_view>

namespace penumbra::weights_tools {

// Whether a module is that package or lies in it.
bool module_lies_in(std::string_view module, std::string_view package);

// Looks at every part of the module and of the dotted name, with and without a "_" before it.
bool is_refused_global(std::string_view module, std::string_view name);

}  // namespace penumbra::weights_tools
