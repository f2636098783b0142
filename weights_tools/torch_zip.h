// PyTorch's checkpoint format since 1.6 (torch.save): a zip file with one folder that holds
//
//   data.pkl     the pickled object, in which a tensor's storage is a key
//   data/KEY     the bytes of each storage, usually stored and not deflated
//   byteorder    "little" or "big" (newer versions), version and others, which are not needed
//
// Source: torch/serialization.py (_save, _load), caffe2/serialize/inline_container.cc, PyTorch 1.13.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "nn/base/mapped_file.h"
#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

// The state dict in it, or the one under `key` where that is not empty (torch_state_dict.h). Only the
// storages of its tensors are read, each once. Throws InputError.
nn::StateDict read_torch_zip(const std::shared_ptr<const MappedFile>& file, const std::string& place,
                             std::string_view key);

}  // namespace penumbra::weights_tools
