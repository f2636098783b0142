// Opens a checkpoint of any format that Penumbra reads, told by its content and not by its name:
// safetensors (memory-mapped), PyTorch zip (1.6 and later) and PyTorch legacy. See docs/formats.md.
#pragma once

#include <filesystem>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

enum class CheckpointFormat { safetensors, pytorch_zip, pytorch_legacy };

const char* to_string(CheckpointFormat format);  // "safetensors", "pytorch-zip", "pytorch-legacy"

// Looks at the first bytes only. Throws InputError for a file that is missing or of no known format.
CheckpointFormat checkpoint_format(const std::filesystem::path& path);

// Throws InputError for a file that is missing, truncated, hostile or of no known format. Nothing in the file
// is ever executed.
nn::StateDict load_weights(const std::filesystem::path& path);

}  // namespace penumbra::weights_tools
