// The network's tensors in a checkpoint's pickled object: which they are, and where their elements lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "weights_tools/pickle_value.h"

namespace penumbra::weights_tools {

// Element (i_0, i_1, ...) lies at index offset + sum over d of i_d * stride[d] of the storage. Checked:
// extents and strides are >= 0, and every index is below StorageRequest::elements.
struct TorchTensor {
  std::string name;
  std::size_t storage = 0;  // index into PickledObject::storages
  std::int64_t offset = 0;  // elements
  std::vector<std::int64_t> shape, stride;
};

// The state dict is the object itself, or what it holds under "state_dict", "model_state_dict" or "model"
// (nested up to four deep). Entries that are no tensors are left out; of a name that stands twice the last
// counts, as in Python; a prefix "module." that all names share (torch.nn.DataParallel) is stripped. Returned
// in order of name. Throws InputError where there is no tensor, or where one does not fit its storage.
std::vector<TorchTensor> find_state_dict(const PickledObject& object, const std::string& place);

}  // namespace penumbra::weights_tools
