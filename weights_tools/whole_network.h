// A network that was pickled as a whole, torch.save(model), read as data: an object of the class
// torch.nn.Module has its tensors in the dicts _parameters and _buffers and its parts in _modules.
//
// Bounds: at most 64 parts deep, and a WalkBudget for all networks of a checkpoint together: parts may share
// each other, and every way to a part counts as one. Source: torch/nn/modules/module.py, _save_to_state_dict,
// whose names these are.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "weights_tools/pickle_value.h"

namespace penumbra::weights_tools {

inline constexpr std::size_t kLongestTensorName = 1024;  // bytes

struct NamedValue {
  std::string name;
  ValueId value = 0;
};

struct WholeNetwork {
  std::vector<NamedValue> tensors;  // as in its state_dict(): without buffers that are not kept
  std::vector<std::string> notes;   // of settings that are not taken
  // What its objects say of themselves, see docs/formats.md: classes, batch_norm_eps, activations; of
  // torchvision's detectors min_size, max_size, anchor_sizes, aspect_ratios, image_mean, image_std.
  std::map<std::string, std::string> metadata;
  std::optional<ValueId> stride;  // YOLOv5's tensor of its levels' strides
};

// What is left of the bounds.
struct WalkBudget {
  std::size_t parts = 200'000;
  std::size_t tensors = 1U << 18;
  std::size_t name_bytes = 64U << 20;
  std::size_t looks = 64'000'000;  // at items of dicts
};

bool is_network(const PickledObject& object, const Value& value);

// Throws InputError where the budget does not suffice.
WholeNetwork read_whole_network(const PickledObject& object, const Value& network, const std::string& place,
                                WalkBudget& budget);

// The names in a list of texts or in a dict {0: text, 1: text, ...} as metadata "classes"; none where it is
// not that.
std::optional<std::string> read_class_list(const PickledObject& object, const Value& value);

}  // namespace penumbra::weights_tools
