// Options of every command that finds object instances: the settings of the network.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "nn/models/make_network.h"

namespace penumbra::apps {

// Adds --min-size and --proposals, what only Mask R-CNN has. `mask_rcnn` must live until the command line is
// parsed.
void add_mask_rcnn_options(CLI::App* command, nn::MaskRcnnConfig& mask_rcnn);

// Adds --precision, also of f32, bf16 and int8 what is fastest here. `set` is called when the command line is
// parsed.
void add_precision_option(CLI::App* command, std::function<void(const nn::LayerPrecision&)> set);

// Adds those, --max-size, --score-threshold, --max-detections, --precision and --no-attention. Where
// Mask R-CNN and YOLOv5 both have a setting, the option sets it for both; each has its own default. `network`
// must live until the command line is parsed.
void add_network_options(CLI::App* command, nn::NetworkConfig& network);

}  // namespace penumbra::apps
