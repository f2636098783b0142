// Writes a run's results one after the other: what cannot be written costs only itself.
#pragma once

#include <fmt/core.h>

#include <exception>
#include <string>
#include <vector>

#include "apps/common/log.h"
#include "nn/base/error.h"

namespace penumbra::apps {

// Remembers what could not be written.
class ResultWriter {
 public:
  template <typename Write>
  void write(Write&& write) {
    try {
      write();
    } catch (const std::exception& error) {
      failures_.emplace_back(error.what());
    }
  }
  // The same of what can be drawn again.
  template <typename Write>
  void draw(Write&& write) {
    try {
      write();
    } catch (const std::exception& error) {
      log_warning("left out: {}", error.what());
    }
  }
  void throw_failures() const {
    if (failures_.empty()) return;
    throw Error(fmt::format("{}{}", failures_.front(),
                            failures_.size() > 1 ? fmt::format(" (and {} more)", failures_.size() - 1) : ""));
  }

 private:
  std::vector<std::string> failures_;
};

}  // namespace penumbra::apps
