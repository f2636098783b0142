// Opens a checkpoint of any format that Penumbra reads, told by its content and not by its name:
// safetensors (memory-mapped), PyTorch zip (1.6 and later) and PyTorch legacy. See docs/formats.md.
#pragma once

#include <filesystem>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

// Throws InputError for a file that is missing, truncated, hostile or of no known format. Nothing in the file
// is ever executed.
nn::StateDict load_weights(const std::filesystem::path& path);

}  // namespace penumbra::weights_tools
