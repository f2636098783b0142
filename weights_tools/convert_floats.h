// Stores a checkpoint's floating-point tensors in another format.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

struct FloatConversion {
  nn::StateDict state;
  std::size_t converted = 0;              // tensors
  std::vector<std::string> out_of_range;  // names of tensors in which a finite value became infinite
};

// f64, f32, f16 and bf16 tensors become `type`, f32 or f16; integers and bools stay as they are. Values are
// rounded to nearest (by way of f32). What need not change is shared with `state`, not copied.
FloatConversion convert_floats(const nn::StateDict& state, nn::DataType type);

}  // namespace penumbra::weights_tools
