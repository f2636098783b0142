// Where in a checkpoint's pickled object the network's weights are. Training scripts put them under any key,
// beside optimisers, averaged copies and numbers about the run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "weights_tools/whole_network.h"

namespace penumbra::weights_tools {

// `notes` also says which of several was taken.
using FoundWeights = WholeNetwork;

// The object itself or what lies in it, up to four keys deep (as "model.state_dict"): a dict of tensors or a
// whole network. Keys with words of optimisers, schedulers, losses and the like are passed over, unless what
// they hold is a network that Penumbra runs. Of several
//   1. the names of a network that Penumbra runs go first;
//   2. then the usual keys: averaged weights (ema, model_ema, ...) that are as complete as the others, before
//      state_dict, model, net, ...;
//   3. then the one with the most tensors.
// `key`, where it is not empty, names the one that is wanted. Throws InputError where there is none, where
// two are equal in this, or where there is nothing under `key`; the message names the keys that there are.
FoundWeights find_weights(const PickledObject& object, const std::string& place, std::string_view key);

}  // namespace penumbra::weights_tools
