// penumbra bench network: Mask R-CNN R50-FPN end to end, on an image of noise.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/benchmark.h"
#include "apps/network/network_options.h"
#include "nn/base/counted.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/random_weights.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

// Random class logits are all alike. With this gain each proposal has a favourite, and so there are more
// detections than any limit.
constexpr double kClassGain = 40.0;

struct NetworkBenchmarkOptions {
  BenchmarkOptions common;
  std::string size = "1242x375", weights;
  int detections = 100;
  bool attention = false;
  nn::MaskRcnnConfig config;
};

std::unique_ptr<nn::MaskRcnn> make_network(const NetworkBenchmarkOptions& options, const ByteImage& image) {
  nn::MaskRcnnConfig config = options.config;
  config.box_head.max_detections = options.detections;
  if (!options.weights.empty()) {
    return std::make_unique<nn::MaskRcnn>(weights_tools::load_weights(options.weights), config);
  }
  nn::StateDict weights = nn::random_mask_rcnn(options.attention, kClassGain);
  if (config.precision.precision == nn::Precision::int8) {  // random weights are calibrated on the spot
    nn::InputRanges ranges;
    nn::MaskRcnnConfig observing = config;
    observing.precision = {nn::Precision::f32, &ranges};
    nn::Arena arena;
    nn::MaskRcnn(weights, observing).detect(image, arena);
    nn::store_input_ranges(ranges, weights);
  }
  return std::make_unique<nn::MaskRcnn>(weights, config);
}

void bench_network(const NetworkBenchmarkOptions& options) {
  const ByteImage image = noise_image(options.size);
  const std::unique_ptr<nn::MaskRcnn> network = make_network(options, image);
  const nn::ImageExtent extent = network->input_extent(image);
  const double peak = peak_gflops();

  nn::Arena arena;
  std::vector<nn::Detection> detections;
  const Timing full = time_repeats(options.common, [&] { network->detect(image, arena, detections); });
  const std::size_t arena_bytes = arena.peak_bytes();
  const int key = 0;
  const Timing pyramid = time_repeats(options.common, [&] {
    const nn::Arena::Pass pass(arena, &key, extent.padded_height, extent.padded_width);
    nn::FeatureMap input(arena, 1, 3, extent.padded_height, extent.padded_width, nn::ResNet::kImageBorder,
                         nn::kImageBlock);
    network->pyramid(std::move(input), arena);
  });
  const double gflop = 2e-9 * network->pyramid_multiply_adds(extent.padded_height, extent.padded_width);

  nlohmann::ordered_json result = machine_json(peak);
  result["precision"] = to_string(network->precision());  // that it runs in, whatever was asked for
  if (nn::is_supported(nn::Precision::bf16)) result["bf16"] = to_string(nn::bf16_arithmetic());
  result["network"] = network->name();
  result["image"] = options.size;
  result["input"] = fmt::format("{}x{}", extent.padded_width, extent.padded_height);
  result["detections"] = detections.size();
  result["backbone_fpn_gflop"] = gflop;
  result["backbone_fpn_seconds"] = pyramid.median;
  result["backbone_fpn_spread"] = pyramid.spread();
  result["backbone_fpn_share_of_peak"] = gflop / pyramid.median / peak;
  result["full_seconds"] = full.median;
  result["full_spread"] = full.spread();
  result["arena_mb"] = static_cast<double>(arena_bytes) * 1e-6;
  if (options.common.json) {
    fmt::print("{}\n", result.dump(2));
    return;
  }
  print_machine(peak);
  const bool bf16 = network->precision() == nn::Precision::bf16;
  fmt::print("{} in {}{}, {} image as {}, {}\n", network->name(), to_string(network->precision()),
             bf16 ? fmt::format(" by {}", to_string(nn::bf16_arithmetic())) : "", options.size,
             result["input"].get<std::string>(), counted(detections.size(), "detection"));
  fmt::print("backbone and pyramid {:8.1f} ms ({:.0f}% spread), {:.1f} GFLOP, {:.2f} x peak\n",
             pyramid.median * 1e3, pyramid.spread() * 100, gflop, gflop / pyramid.median / peak);
  fmt::print("full network         {:8.1f} ms ({:.0f}% spread), {:.0f} MB of activations\n",
             full.median * 1e3, full.spread() * 100, static_cast<double>(arena_bytes) * 1e-6);
}

}  // namespace

void add_network_benchmark(CLI::App& bench) {
  auto options = std::make_shared<NetworkBenchmarkOptions>();
  CLI::App* command = bench.add_subcommand("network", "Mask R-CNN end to end");
  command->add_option("--size", options->size, "the image's WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--detections", options->detections, "most instances")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--weights", options->weights, "Mask R-CNN weights [random ones, R50-FPN, 91 classes]");
  command->add_flag("--attention", options->attention, "random weights with mixed attention");
  add_mask_rcnn_options(command, options->config);
  add_precision_option(
      command, [options](const nn::LayerPrecision& precision) { options->config.precision = precision; });
  add_benchmark_options(command, options->common);
  command->footer(
      "Examples:\n"
      "  penumbra bench network --size 1242x375 --detections 100 --json\n"
      "  penumbra bench network --size 640x480 --min-size 400 --detections 20 --proposals 200\n"
      "  penumbra bench network --precision bf16\n"
      "  penumbra bench network --weights maskrcnn.safetensors --isa avx2 --threads 1\n");
  command->callback([options] { bench_network(*options); });
}

}  // namespace penumbra::apps
