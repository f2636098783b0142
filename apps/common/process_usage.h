// What the process, or the children that it has waited for, have used so far.
#pragma once

#include <sys/resource.h>

namespace penumbra::apps {

struct ProcessUsage {
  double cpu_seconds = 0.0;  // of all threads, in the program and in the kernel
  double peak_rss_mb = 0.0;  // largest resident memory, MiB
};

// `who` is RUSAGE_SELF or RUSAGE_CHILDREN: of these all seconds, and the memory of the largest.
inline ProcessUsage process_usage(int who = RUSAGE_SELF) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024.0};
}

}  // namespace penumbra::apps
