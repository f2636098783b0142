// Where the processor's time goes: a run's stages, thread by thread.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "nn/base/stage_timer.h"

namespace penumbra::apps {

// Thread -> stage -> milliseconds a frame, and under "other" what of `cpu_seconds`, of all threads, no stage
// was timed for: the threads' own work between the stages, a network's helpers, the results. With
// --deterministic one thread does the work of several; the rows stay theirs.
nlohmann::json processor_report(const StageTimer::ProcessorTimes& times, double cpu_seconds,
                                std::size_t frames);

// That as a table, a thread and its stages after the other, the dearest first.
std::string processor_table(const nlohmann::json& report);

}  // namespace penumbra::apps
