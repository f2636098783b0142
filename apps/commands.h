// The subcommands of `penumbra`, one file each: every function adds its command with options, examples and
// the callback that runs it. A command throws UsageError (exit code 2) or any other exception (exit code 1).
#pragma once

#include <CLI/CLI.hpp>

namespace penumbra::apps {

void add_eval_command(CLI::App& app);
void add_slam_command(CLI::App& app);
void add_synth_command(CLI::App& app);  // penumbra synth: render a synthetic drive

}  // namespace penumbra::apps
