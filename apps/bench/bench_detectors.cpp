// penumbra bench detectors: several networks on the same image, in turn, so that a machine that slows down
// slows all of them.
#include <fmt/format.h>

#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/benchmark.h"
#include "apps/network/load_network.h"
#include "apps/network/network_options.h"
#include "nn/base/quantile.h"
#include "nn/base/stopwatch.h"

namespace penumbra::apps {

namespace {

struct DetectorsBenchmarkOptions {
  BenchmarkOptions common;
  std::string size = "640x480";
  std::vector<std::string> weights;
  nn::NetworkConfig network;
};

struct Contender {
  LoadedNetwork loaded;
  nn::Arena arena;
  std::vector<nn::Detection> detections;
  std::vector<double> wall,
      processor;  // milliseconds of each repeat; processor: of all threads, also those that wait
};

void bench_detectors(const DetectorsBenchmarkOptions& options) {
  const ByteImage image = noise_image(options.size);
  std::vector<std::unique_ptr<Contender>> contenders;
  for (const std::string& weights : options.weights) {
    contenders.push_back(std::make_unique<Contender>());
    contenders.back()->loaded = load_network(weights, {}, options.network);
  }
  for (int repeat = -options.common.warm_up; repeat < options.common.repeats; ++repeat) {
    for (const auto& contender : contenders) {
      const Stopwatch stopwatch;
      const std::clock_t before = std::clock();
      contender->loaded.network->detect(image, contender->arena, contender->detections);
      if (repeat < 0) continue;
      contender->processor.push_back(1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
      contender->wall.push_back(stopwatch.milliseconds());
    }
  }
  const double peak = peak_gflops();
  nlohmann::ordered_json result = machine_json(peak);
  result["image"] = options.size;
  if (!options.common.json) print_machine(peak);
  for (const auto& contender : contenders) {
    const Contender& first = *contenders.front();
    const double wall = quantile_of(contender->wall, 0.5), processor = quantile_of(contender->processor, 0.5);
    const double ratio = wall / quantile_of(first.wall, 0.5);
    const double processor_ratio = processor / quantile_of(first.processor, 0.5);
    result["networks"].push_back({{"weights", contender->loaded.source},
                                  {"network", contender->loaded.network->name()},
                                  {"median_ms", wall},
                                  {"median_ratio", ratio},
                                  {"processor_ms", processor},
                                  {"processor_ratio", processor_ratio}});
    if (options.common.json) continue;
    fmt::print("{:34} {:7.2f} ms ({:.3f} x the first), processor {:7.2f} ms ({:.3f} x), {}\n",
               contender->loaded.network->name(), wall, ratio, processor, processor_ratio,
               contender->loaded.source);
  }
  if (options.common.json) fmt::print("{}\n", result.dump(2));
}

}  // namespace

void add_detectors_benchmark(CLI::App& bench) {
  auto options = std::make_shared<DetectorsBenchmarkOptions>();
  options->common.repeats = 50;
  options->network.yolov5.score_threshold = 0.25F;  // as for a picture: few boxes of noise pass
  CLI::App* command =
      bench.add_subcommand("detectors", "Networks against each other: YOLOv5, AFNET or Mask R-CNN");
  command->add_option("weights", options->weights, "weights files; ratios are to the first")->required();
  command->add_option("--size", options->size, "the image's WIDTHxHEIGHT")->capture_default_str();
  add_network_options(command, options->network);
  add_benchmark_options(command, options->common);
  command->footer(
      "Example:\n"
      "  penumbra bench detectors weights_tools/models/penumbra-office.safetensors \\\n"
      "    weights_tools/models/penumbra-afnet.safetensors --threads 1\n");
  command->callback([options] { bench_detectors(*options); });
}

}  // namespace penumbra::apps
