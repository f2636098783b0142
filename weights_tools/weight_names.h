// The names of a network's tensors, without what wrappers of networks put before them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

// Whether it is the counter that AveragedModel (n_averaged) and mmengine's ExponentialMovingAverage (steps)
// keep beside the names of the network.
bool is_averaging_counter(std::string_view name);

struct OwnNames {
  std::vector<std::string> names;     // in the order of what was given; empty where the tensor is left out
  std::vector<std::string> left_out;  // as given
};

// The same names without the prefixes that all of them share and that wrappers made, taken off again and
// again: "module." (DataParallel, AveragedModel) and "model." (Lightning). YOLOv5's own "model.0." stays.
// "_orig_mod." (torch.compile) and its kin are taken out wherever they stand.
//
// Where a few entries are foreign (criterion.weight, val_map.x beside model.*), or the prefix is another
// (net., detector.), what has the prefix counts if it is one whole network that Penumbra runs; the foreign
// entries are left out: at most one for every four of the network. Averaging counters are left out beside
// wrapped names.
OwnNames without_wrappers(const std::vector<std::string>& given);

// Whether the names, without wrappers, are those of a network that Penumbra runs.
bool are_of_a_known_network(const std::vector<std::string>& names);

// Gives the tensors their own names. Notes say what was done and what was left out.
void unwrap_names(nn::StateDict& state);

}  // namespace penumbra::weights_tools
