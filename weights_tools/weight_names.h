// The names of a network's tensors, without what wrappers of networks put before them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

// The counter of torch.optim.swa_utils.AveragedModel, which stands beside the names of the network.
inline constexpr std::string_view kAveragingCounter = "n_averaged";

// The same names without the prefixes that all of them share and that wrappers made, taken off again and
// again: "module." (DataParallel, AveragedModel) and "model." (Lightning). YOLOv5's own "model.0." stays.
// "_orig_mod." (torch.compile) and its kin are taken out wherever they stand.
std::vector<std::string> without_wrappers(std::vector<std::string> names);

// Whether the names, without wrappers, are those of a network that Penumbra runs.
bool are_of_a_known_network(const std::vector<std::string>& names);

// Gives the tensors their own names; leaves kAveragingCounter out where it stands beside wrapped ones. Notes
// say what was done.
void unwrap_names(nn::StateDict& state);

}  // namespace penumbra::weights_tools
