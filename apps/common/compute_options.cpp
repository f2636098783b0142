#include "apps/common/compute_options.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "nn/base/parallel.h"
#include "nn/simd/isa.h"

namespace penumbra::apps {

void add_threads_option(CLI::App* command) {
  command->add_option_function<int>("--threads", set_thread_count, "threads (default: all processors)")
      ->check(CLI::Range(1, 1024));
}

void add_isa_option(CLI::App* command) {
  std::vector<const char*> names;
  for (const nn::Isa isa : nn::kIsas) names.push_back(to_string(isa));
  command->add_option_function<std::string>(
      "--isa", [](const std::string& name) { nn::use_isa(nn::isa_from_name(name)); },
      fmt::format("instruction set of the network: {} (default: the widest here that is not emulated)",
                  fmt::join(names, ", ")));
}

}  // namespace penumbra::apps
