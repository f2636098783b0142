// A network and the names of its classes, from a weights file.
#pragma once

#include <CLI/CLI.hpp>
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

// The weights under `key` of a checkpoint (load_weights.h), with its notes logged.
nn::StateDict load_noted_weights(const std::filesystem::path& path, const std::string& key);

// Adds --key.
void add_key_option(CLI::App* command, std::string& key);

// `classes` is a file of class names or empty. The weights file is closed again: the network keeps its own
// copy, in the order in which its kernels read it.
LoadedNetwork load_network(const std::filesystem::path& weights, const std::filesystem::path& classes,
                           const nn::NetworkConfig& config, const std::string& key = {});

}  // namespace penumbra::apps
