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
  std::size_t batch_norms = 0;            // tensors that stay f32 as they belong to a batch norm
  std::vector<std::string> out_of_range;  // names of tensors that stay f32 as f16 cannot hold their values
};

// f64, f32, f16 and bf16 tensors become `type`, f32 or f16; integers and bools stay as they are. Values are
// rounded to nearest (by way of f32). What need not change is shared with `state`, not copied.
//
// What f16 would falsify becomes f32 instead:
//   - the vectors of a batch norm (those beside a "running_var"): a dead channel's variance of 1e-9 would
//     become 0, by whose root its weights are divided
//   - a tensor with a value beyond f16's range, or with a row (an output channel) of which every value that
//     is not 0 is below f16's normal range: such rows are as small as the variance of their channel
//
// Throws InputError where a finite f64 lies beyond the range of f32.
FloatConversion convert_floats(const nn::StateDict& state, nn::DataType type);

// Takes out the tensors that no safetensors file may hold, those of C128, and returns their names.
std::vector<std::string> leave_out_unwritable(nn::StateDict& state);

}  // namespace penumbra::weights_tools
