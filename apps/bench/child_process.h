// Runs this program again, as a process of its own: what it measures about itself is then its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace penumbra::apps {

struct ChildResult {
  int exit_code = 0;         // 128 + signal where a signal ended it
  double wall_s = 0.0;       // seconds
  double cpu_s = 0.0;        // of all its threads
  double peak_rss_mb = 0.0;  // largest resident memory
};

// `penumbra ARGUMENTS`, with standard output and error into `log`. Waits for it. Throws Error where it cannot
// be started.
ChildResult run_penumbra(const std::vector<std::string>& arguments, const std::filesystem::path& log);

}  // namespace penumbra::apps
