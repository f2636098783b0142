// A command that is run for its time.
#pragma once

#include <cstdio>
#include <string>

#include "apps/common/process_usage.h"
#include "nn/base/error.h"

namespace penumbra {

// What a command prints, and the processor time of its process.
struct Child {
  std::string output;
  double processor_seconds = 0.0;
};

// Throws Error where it fails.
inline Child run_child(const std::string& command) {
  const double before = apps::process_usage(RUSAGE_CHILDREN).cpu_seconds;
  Child child;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw Error("cannot run " + command);
  char buffer[4096];
  while (const std::size_t read = std::fread(buffer, 1, sizeof(buffer), pipe))
    child.output.append(buffer, read);
  if (pclose(pipe) != 0) throw Error(command + " failed");
  child.processor_seconds = apps::process_usage(RUSAGE_CHILDREN).cpu_seconds - before;
  return child;
}

}  // namespace penumbra
