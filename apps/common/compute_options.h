// Options of every command that runs the network: how many threads, which instruction set.
#pragma once

#include <CLI/CLI.hpp>

namespace penumbra::apps {

// Adds --threads N (nn/base/parallel.h; default: all processors).
void add_threads_option(CLI::App* command);
// Adds --isa NAME (default: the widest that this machine has).
void add_isa_option(CLI::App* command);

}  // namespace penumbra::apps
