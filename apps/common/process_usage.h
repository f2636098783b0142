// What the process has used so far.
#pragma once

#include <sys/resource.h>

namespace penumbra::apps {

struct ProcessUsage {
  double cpu_seconds = 0.0;  // of all threads, in the program and in the kernel
  double peak_rss_mb = 0.0;  // largest resident memory, MiB
};

inline ProcessUsage process_usage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024.0};
}

}  // namespace penumbra::apps
