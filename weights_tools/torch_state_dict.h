// The network's tensors in a checkpoint's pickled object: which they are, and where their elements lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
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

struct TorchState {
  std::vector<TorchTensor> tensors;             // in order of name
  std::optional<TorchTensor> stride;            // a whole YOLOv5's: its values are metadata
  std::map<std::string, std::string> metadata;  // of a whole network, and class names
  std::vector<std::string> notes;               // for the user
};

// The tensors that find_weights.h finds, checked. Throws InputError where there is none, where one does not
// fit its storage, and where one is of a kind that is not read.
TorchState find_state_dict(const PickledObject& object, const std::string& place, std::string_view key = {});

}  // namespace penumbra::weights_tools
