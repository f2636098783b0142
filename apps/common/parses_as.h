// Check of a word on the command line by the function that reads it, so that what is no such word is refused
// before anything is begun, and by `penumbra fleet plan` for all its jobs.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "nn/base/error.h"

namespace penumbra::apps {

// `parse` throws UsageError for what it cannot read; what it returns is dropped.
template <class Parse>
CLI::Validator parses_as(Parse parse) {
  return CLI::Validator(
      [parse](std::string& text) {
        try {
          parse(text);
        } catch (const UsageError& error) {
          return std::string(error.what());
        }
        return std::string();
      },
      "");
}

}  // namespace penumbra::apps
