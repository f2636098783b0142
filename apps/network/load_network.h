// Reads a network for a command: what its weights file has to say is logged.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "apps/network/loaded_network.h"

namespace penumbra::apps {

// The weights under `key` of a checkpoint (load_weights.h), with its notes logged.
nn::StateDict load_noted_weights(const std::filesystem::path& path, const std::string& key);

// Adds --key.
void add_key_option(CLI::App* command, std::string& key);

// `classes` is a file of class names or empty. The weights file is closed again.
LoadedNetwork load_network(const std::filesystem::path& weights, const std::filesystem::path& classes,
                           const nn::NetworkConfig& config, const std::string& key = {});

}  // namespace penumbra::apps
