// `penumbra match-eval`, with another kind of feature beside ours where the program has one.
#pragma once

#include <CLI/CLI.hpp>

#include "slam/evaluation/matching_evaluation.h"

namespace penumbra::apps {

// `baseline` may be empty.
void add_match_eval_command(CLI::App& app, slam::BaselineMaker baseline);

}  // namespace penumbra::apps
