// Opens a checkpoint of any format that Penumbra reads, told by its content and not by its name:
// safetensors (memory-mapped), PyTorch zip (1.6 and later) and PyTorch legacy. See docs/formats.md.
#pragma once

#include <filesystem>
#include <string_view>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

enum class CheckpointFormat { safetensors, pytorch_zip, pytorch_legacy };

const char* to_string(CheckpointFormat format);  // "safetensors", "pytorch-zip", "pytorch-legacy"

// Looks at the first bytes only. Throws InputError for a file that is missing or of no known format.
CheckpointFormat checkpoint_format(const std::filesystem::path& path);

// The network's tensors under their own names: without the prefixes that wrappers made (weight_names.h), of a
// whole PyTorch checkpoint only the weights (find_weights.h). `key`, where it is not empty, says under which
// key they are: of a PyTorch checkpoint, or before the first dot of a safetensors file's names. What was
// chosen stands in the notes. Throws InputError for a file that is missing, truncated, hostile, of no known
// format or without tensors. Nothing in the file is ever executed.
nn::StateDict load_weights(const std::filesystem::path& path, std::string_view key = {});

}  // namespace penumbra::weights_tools
