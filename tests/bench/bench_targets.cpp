// Our convolutions beside oneDNN's in f32, bf16 and int8, the whole network in each, and the program's start:
//
//   bench_targets [REPEATS [THREADS]]      prints JSON; 1 thread unless said
//
// Everything that is compared takes turns, and the medians of processor time count, so that a machine that
// slows down slows all of them; all that is measured with a `target` is listed at the end. `reached` are
// ratios of times, `target` what they are to be at most. Not part of the tests: `ninja bench_targets` builds
// it where oneDNN 2 (Debian's libdnnl-dev) is installed.
#include <fmt/format.h>
#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/bench/benchmark.h"
#include "apps/bench/conv_layers.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/base/quantile.h"
#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/random_weights.h"
#include "nn/simd/amx_permission.h"
#include "nn/simd/low_precision.h"
#include "tests/bench/onednn_layer.h"

namespace penumbra {
namespace {

using nlohmann::ordered_json;
using nn::Precision;

constexpr int kHeight = 416, kWidth = 1344;  // of the network's input for an image of 1242 x 375
constexpr double kClassGain = 40.0;          // as in bench_network.cpp: more detections than any limit

// Median processor time of each, in turn, after two rounds that do not count; seconds.
std::vector<double> processor_seconds(const std::vector<std::function<void()>>& works, int repeats) {
  constexpr int kWarmUp = 2;
  std::vector<std::vector<double>> seconds(works.size());
  for (int repeat = -kWarmUp; repeat < repeats; ++repeat) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      const std::clock_t before = std::clock();
      works[i]();
      if (repeat >= 0) seconds[i].push_back(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& s : seconds) medians.push_back(quantile_of(s, 0.5));
  return medians;
}

ordered_json compare_layers(Precision precision, int repeats) {
  ordered_json rows = ordered_json::array();
  double logarithms = 0.0;
  const std::vector<apps::ConvShape> shapes = apps::compared_shapes(kHeight, kWidth);
  for (const apps::ConvShape& shape : shapes) {
    apps::ConvLayer ours(shape, precision);
    OneDnnLayer theirs(shape, precision);
    const std::vector<double> seconds =
        processor_seconds({[&] { ours.run(); }, [&] { theirs.run(); }}, repeats);
    logarithms += std::log(seconds[0] / seconds[1]);
    rows.push_back({{"layer", shape.name},
                    {"ours_ms", 1e3 * seconds[0]},
                    {"onednn_ms", 1e3 * seconds[1]},
                    {"ratio", seconds[0] / seconds[1]},
                    {"method", ours.algorithm()},
                    {"onednn", theirs.implementation()}});
  }
  return {{"layers", rows}, {"geometric_mean", std::exp(logarithms / static_cast<double>(shapes.size()))}};
}

struct Network {
  nn::MaskRcnn network;
  nn::Arena arena;
  std::vector<nn::Detection> detections;
  Network(const nn::StateDict& weights, Precision precision) : network(weights, config(precision)) {}
  static nn::MaskRcnnConfig config(Precision precision) {
    nn::MaskRcnnConfig config;
    config.precision.precision = precision;
    return config;
  }
};

// Seconds of a whole image by precision, those that this machine has.
ordered_json compare_networks(const std::vector<Precision>& precisions, int repeats) {
  const ByteImage image = apps::noise_image("1242x375");
  nn::StateDict weights = nn::random_mask_rcnn(false, kClassGain);
  nn::InputRanges ranges;
  {
    nn::MaskRcnnConfig observing;
    observing.precision = {Precision::f32, &ranges};
    nn::Arena arena;
    nn::MaskRcnn(weights, observing).detect(image, arena);
  }
  nn::store_input_ranges(ranges, weights);
  std::vector<std::unique_ptr<Network>> networks;
  std::vector<std::function<void()>> works;
  for (const Precision precision : precisions) {
    Network* network = networks.emplace_back(std::make_unique<Network>(weights, precision)).get();
    works.push_back(
        [network, &image] { network->network.detect(image, network->arena, network->detections); });
  }
  const std::vector<double> seconds = processor_seconds(works, repeats);
  ordered_json result;
  for (std::size_t i = 0; i < precisions.size(); ++i) {
    result[to_string(precisions[i])] = {{"processor_ms", 1e3 * seconds[i]},
                                        {"ratio_to_f32", seconds[i] / seconds[0]},
                                        {"detections", networks[i]->detections.size()}};
  }
  return result;
}

// What a command prints, and the processor time of its process.
struct Child {
  std::string output;
  double processor_seconds = 0.0;
};

Child run_child(const std::string& command) {
  const auto children_seconds = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  };
  const double before = children_seconds();
  Child child;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw Error("cannot run " + command);
  char buffer[4096];
  while (const std::size_t read = std::fread(buffer, 1, sizeof(buffer), pipe))
    child.output.append(buffer, read);
  if (pclose(pipe) != 0) throw Error(command + " failed");
  child.processor_seconds = children_seconds() - before;
  return child;
}

// Processor time of `penumbra segment` from its start to the end of its first image, by that of one image
// more.
double start_ratio(const std::string& penumbra, int threads) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("bench_targets_{}", getpid());
  std::filesystem::create_directories(folder);
  nn::write_safetensors(folder / "weights.safetensors", nn::random_mask_rcnn(false, kClassGain));
  for (const char* name : {"a.png", "b.png", "c.png"})
    nn::write_image(folder / name, apps::noise_image("1242x375"));
  const auto seconds = [&](const std::string& images) {
    return run_child(
               fmt::format(
                   "cd '{0}' && '{1}' segment {2} --weights weights.safetensors --threads {3} --out out 2>&1",
                   folder.string(), penumbra, images, threads))
        .processor_seconds;
  };
  const double first = seconds("a.png"), steady = (seconds("a.png b.png c.png") - first) / 2.0;
  std::filesystem::remove_all(folder);
  return first / steady;
}

int run(int repeats, int threads, const std::string& penumbra) {
  set_thread_count(threads);
  omp_set_num_threads(threads);  // oneDNN's
  std::vector<Precision> precisions{Precision::f32};
  for (const Precision precision : {Precision::bf16, Precision::int8}) {
    if (nn::is_supported(precision)) precisions.push_back(precision);
  }
  ordered_json result = apps::machine_json(apps::peak_gflops());
  result["amx"] = describe(nn::amx_state());
  if (nn::is_supported(Precision::bf16)) result["bf16"] = to_string(nn::bf16_arithmetic());
  const dnnl_version_t* version = dnnl_version();
  result["onednn_version"] = fmt::format("{}.{}.{}", version->major, version->minor, version->patch);
  const bool tiles = nn::current_isa() == nn::Isa::amx;
  ordered_json targets = ordered_json::array();
  const auto add_target = [&](const std::string& what, double reached, double target) {
    targets.push_back({{"what", what}, {"reached", reached}, {"target", target}});
  };
  for (const Precision precision : precisions) {
    const std::string name = to_string(precision);
    result["layers"][name] = compare_layers(precision, repeats);
    const double mean = result["layers"][name]["geometric_mean"];
    if (tiles && precision != Precision::f32) add_target("layers against oneDNN, " + name, mean, 0.8);
    if (precision == Precision::f32) {
      double most = 0.0;
      for (const ordered_json& row : result["layers"][name]["layers"]) {
        if (row["layer"].get<std::string>().find("1x1") != std::string::npos) {
          most = std::max(most, row["ratio"].get<double>());
        }
      }
      add_target("slowest 1x1 layer against oneDNN, f32", most, 0.85);
    }
  }
  result["network"] = compare_networks(precisions, std::max(repeats / 4, 3));
  for (const Precision precision : precisions) {
    if (precision == Precision::f32) continue;
    const std::string name = to_string(precision);
    const double least = tiles ? (precision == Precision::bf16 ? 0.30 : 0.20) : 1.0;
    add_target("network, " + name + " against f32", result["network"][name]["ratio_to_f32"], least);
  }
  add_target("process start to first image against one more image", start_ratio(penumbra, threads), 1.5);
  result["targets"] = targets;
  fmt::print("{}\n", result.dump(2));
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  const int repeats = argc > 1 ? std::max(std::atoi(argv[1]), 1) : 20;
  const int threads = argc > 2 ? std::max(std::atoi(argv[2]), 1) : 1;
  // The program itself lies beside this one.
  const std::filesystem::path program =
      std::filesystem::canonical("/proc/self/exe").parent_path() / "penumbra";
  return penumbra::run(repeats, threads, program.string());
}
