// Our convolutions beside oneDNN's in f32, bf16 and int8, the whole network in each, also beside ONNX Runtime
// and PyTorch, and the program's start:
//
//   bench_targets [REPEATS [THREADS [PYTHON...]]]      prints JSON; 1 thread and python3 unless said
//
// Each peer runs in the first of the Pythons that has it (peers.py); what is missing is said in its place.
// Everything that is compared takes turns, and the medians of processor time count, so that a machine that
// slows down slows all of them; all that is measured with a `target` is listed at the end. `reached` are
// ratios of times, `target` what they are to be at most. Not part of the tests: `ninja bench_targets` builds
// it where oneDNN 2 (Debian's libdnnl-dev) is installed.
#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/bench/benchmark.h"
#include "apps/bench/conv_layers.h"
#include "nn/base/parallel.h"
#include "nn/base/quantile.h"
#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/random_weights.h"
#include "nn/simd/amx_permission.h"
#include "nn/simd/kernel_table.h"
#include "nn/simd/low_precision.h"
#include "tests/bench/child.h"
#include "tests/bench/compare_peers.h"
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

// GFLOP/s of the peak loop on one thread, by processor time; the best of some runs.
double peak_of_one_thread() {
  constexpr long kIterations = 2'000'000;
  double best = 0.0;
  for (int run = 0; run < 9; ++run) {
    const std::clock_t before = std::clock();
    const double operations = nn::kernels().peak_loop(kIterations);
    best = std::max(best, 1e-9 * operations * CLOCKS_PER_SEC / static_cast<double>(std::clock() - before));
  }
  return best;
}

// `peak`: GFLOP/s of one thread in f32. Where oneDNN reaches a share of it in a 1x1 layer, nobody can take
// less than that share of its time.
ordered_json compare_layers(Precision precision, int repeats, double peak) {
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
    if (precision == Precision::f32 && shape.kernel == 1) {
      rows.back()["least_possible_ratio"] = ours.gflop() / seconds[1] / peak;
    }
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

// Processor time of `penumbra segment` from its start to the end of its first image, and of one image more;
// seconds.
struct Start {
  double first, steady;
};

Start measure_start(const std::string& penumbra, int threads) {
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
  return {first, steady};
}

ordered_json compare_with_peers(int repeats, int threads, const std::vector<std::string>& pythons,
                                double first_image_seconds) {
  const ByteImage image = apps::noise_image("1242x375");
  Network ours(nn::random_mask_rcnn(false, kClassGain), Precision::f32);
  PeerComparison comparison;
  comparison.pythons = pythons;
  comparison.repeats = repeats;
  comparison.threads = threads;
  comparison.first_image_seconds = first_image_seconds;
  comparison.full = [&] { ours.network.detect(image, ours.arena, ours.detections); };
  const int key = 0;
  comparison.backbone = [&] {
    const nn::Arena::Pass pass(ours.arena, &key, kHeight, kWidth);
    nn::FeatureMap input(ours.arena, 1, 3, kHeight, kWidth, nn::ResNet::kImageBorder, nn::kImageBlock);
    ours.network.pyramid(std::move(input), ours.arena);
  };
  return compare_peers(comparison);
}

int run(int repeats, int threads, const std::vector<std::string>& pythons, const std::string& penumbra) {
  set_thread_count(threads);
  setenv("OMP_NUM_THREADS", fmt::format("{}", threads).c_str(), 1);  // of the peers' libraries
  omp_set_num_threads(threads);                                      // oneDNN's
  std::vector<Precision> precisions{Precision::f32};
  for (const Precision precision : {Precision::bf16, Precision::int8}) {
    if (nn::is_supported(precision)) precisions.push_back(precision);
  }
  ordered_json result = apps::machine_json(apps::peak_gflops());
  const double peak = peak_of_one_thread();
  result["peak_gflops_by_processor_time"] = peak;
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
    result["layers"][name] = compare_layers(precision, repeats, peak);
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
  const Start start = measure_start(penumbra, threads);
  add_target("process start to first image against one more image", start.first / start.steady, 1.5);
  const ordered_json peers = compare_with_peers(std::max(repeats / 4, 3), threads, pythons, start.first);
  result["peers"] = peers;
  const auto ratio = [&](const char* engine, const char* what) -> std::optional<double> {
    const ordered_json& found = peers.at(engine);
    if (!found.contains(what)) return std::nullopt;
    const ordered_json& row = found.at(what);
    if (row.is_number()) return row.get<double>();
    return row.contains("ratio") ? std::optional(row.at("ratio").get<double>()) : std::nullopt;
  };
  if (const auto found = ratio("onnxruntime", "backbone")) {
    add_target("backbone and pyramid against ONNX Runtime, f32", *found, 0.65);
  }
  if (const auto found = ratio("onnxruntime", "full")) {
    for (const Precision precision : precisions) {
      const double target = precision == Precision::f32 ? 0.33 : precision == Precision::bf16 ? 0.09 : 0.06;
      const double own = result["network"][to_string(precision)]["ratio_to_f32"];
      if (tiles || precision == Precision::f32) {
        add_target(fmt::format("network in {} against ONNX Runtime in f32", to_string(precision)),
                   *found * own, target);
      }
    }
  }
  if (const auto found = ratio("torch", "start_ratio")) {
    add_target("process start to first image against PyTorch's process", *found, 0.25);
  }
  result["targets"] = targets;
  fmt::print("{}\n", result.dump(2));
  return 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a peer that ends is an Error, see peer.h
  const int repeats = argc > 1 ? std::max(std::atoi(argv[1]), 1) : 20;
  const int threads = argc > 2 ? std::max(std::atoi(argv[2]), 1) : 1;
  // The program itself lies beside this one.
  const std::filesystem::path program =
      std::filesystem::canonical("/proc/self/exe").parent_path() / "penumbra";
  std::vector<std::string> pythons(argv + std::min(argc, 3), argv + argc);
  if (pythons.empty()) pythons.emplace_back("python3");
  return penumbra::run(repeats, threads, pythons, program.string());
}
