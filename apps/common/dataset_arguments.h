// Which dataset, and which of its frames: the arguments that commands share.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "slam/sources/open_dataset.h"

namespace penumbra::apps {

struct DatasetArguments {
  std::string folder, format = "auto", frames, sequence, images = "auto";
  int step = 1;
  std::optional<int> image_bits;
  std::optional<double> frame_rate, pair_within;
  slam::TopicNames topics;
  std::string camera;  // calibration file, of bags and streams
};

// Adds the folder itself, described by `help`, and --format, --frames, --step and --image-bits. `arguments`
// must outlive the command.
void add_dataset_arguments(CLI::App& command, DatasetArguments& arguments, const std::string& help);

// Adds --images, --rate, --pair-within, --sequence, --camera and the topics, for commands that run through
// one recording.
void add_recording_arguments(CLI::App& command, DatasetArguments& arguments);

// What they say; errors of --frames as slam::parse_frame_range has them.
slam::DatasetOptions dataset_options(const DatasetArguments& arguments);

}  // namespace penumbra::apps
