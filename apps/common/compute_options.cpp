#include "apps/common/compute_options.h"

#include <string>

#include "nn/base/parallel.h"
#include "nn/simd/isa.h"

namespace penumbra::apps {

void add_threads_option(CLI::App* command) {
  command->add_option_function<int>("--threads", set_thread_count, "threads (default: all processors)")
      ->check(CLI::Range(1, 1024));
}

void add_isa_option(CLI::App* command) {
  command->add_option_function<std::string>(
      "--isa", [](const std::string& name) { nn::use_isa(nn::isa_from_name(name)); },
      "instruction set of the network: baseline, avx2, avx512, amx, or for tests amx-emulated (default: the "
      "widest here)");
}

}  // namespace penumbra::apps
