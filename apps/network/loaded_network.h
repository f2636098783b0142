// A network and the names of its classes, from a weights file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "nn/models/make_network.h"

namespace penumbra::apps {

struct LoadedNetwork {
  std::string source;  // the weights file, for messages
  std::shared_ptr<nn::InstanceSegmenter> network;
  std::vector<std::string> names;  // one a class, see nn/models/class_names.h
};

// Of weights that were read (weights_tools/load_weights.h). `classes` is a file of class names or empty. The
// weights may go: the network keeps its own copy, in the order in which its kernels read it.
LoadedNetwork network_of(const nn::StateDict& weights, const std::filesystem::path& source,
                         const std::filesystem::path& classes, const nn::NetworkConfig& config);

}  // namespace penumbra::apps
