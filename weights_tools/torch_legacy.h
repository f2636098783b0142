// PyTorch's checkpoint format before 1.6, still written on request and by many published weights: pickles and
// raw bytes, one behind the other:
//
//   pickle: the magic number    pickle: the protocol version, 1001    pickle: {"little_endian": True, ...}
//   pickle: the object          pickle: [storage keys]
//   for each key: the number of elements (int64), then the elements
//
// Source: torch/serialization.py (_legacy_save, _legacy_load), PyTorch 1.13.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "nn/base/mapped_file.h"
#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

// True where a pickle begins, of this format or of another.
bool begins_like_a_pickle(std::span<const std::byte> bytes);

// The state dict in it, or the one under `key` where that is not empty (torch_state_dict.h). Tensors view the
// file where they lie contiguously. Throws InputError.
nn::StateDict read_torch_legacy(const std::shared_ptr<const MappedFile>& file, const std::string& place,
                                std::string_view key);

}  // namespace penumbra::weights_tools
