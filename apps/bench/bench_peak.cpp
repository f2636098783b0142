// penumbra bench peak: what the processor's multiply-add units can do at best.
#include <fmt/format.h>

#include <memory>

#include "apps/bench/benchmark.h"

namespace penumbra::apps {

void add_peak_benchmark(CLI::App& bench) {
  auto options = std::make_shared<BenchmarkOptions>();
  CLI::App* command = bench.add_subcommand("peak", "Multiply-adds that never leave the registers");
  add_benchmark_options(command, *options);
  command->footer(
      "Examples:\n"
      "  penumbra bench peak\n"
      "  penumbra bench peak --threads 1 --isa avx2 --json\n");
  command->callback([options] {
    double gflops = 0.0;
    const Timing timing = time_repeats(*options, [&] { gflops = std::max(gflops, peak_gflops()); });
    if (options->json) {
      nlohmann::ordered_json result = machine_json(gflops);
      result["spread"] = timing.spread();
      fmt::print("{}\n", result.dump(2));
    } else {
      print_machine(gflops);
    }
  });
}

}  // namespace penumbra::apps
