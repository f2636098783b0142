// penumbra bench conv: every convolution shape of Mask R-CNN R50-FPN, or one of your own.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/bench/benchmark.h"
#include "apps/bench/conv_layers.h"
#include "nn/base/error.h"
#include "nn/simd/low_precision.h"

namespace penumbra::apps {

namespace {

struct ConvBenchmarkOptions {
  BenchmarkOptions common;
  std::string size = "1344x416", one;
  nn::Precision precision = nn::Precision::f32;
};

// "1344x416" or "256,256,104x336,3,1".
ConvShape parse_shape(const std::string& text) {
  ConvShape shape{text, 1, 0, 0, 0, 0, 0, 0};
  int end = 0;
  const int read = std::sscanf(text.c_str(), "%d,%d,%dx%d,%d,%d%n", &shape.channels, &shape.outputs,
                               &shape.width, &shape.height, &shape.kernel, &shape.stride, &end);
  const bool whole = read == 6 && static_cast<std::size_t>(end) == text.size();
  const auto in = [](int value, int most) { return value >= 1 && value <= most; };
  if (!whole || !in(shape.channels, 8192) || !in(shape.outputs, 8192) || !in(shape.width, 8192) ||
      !in(shape.height, 8192) || !in(shape.kernel, 15) || !in(shape.stride, 8)) {
    throw UsageError("--shape: expected CHANNELS,OUTPUTS,WIDTHxHEIGHT,KERNEL,STRIDE, found '" + text + "'");
  }
  return shape;
}

nlohmann::ordered_json run(const ConvShape& shape, const ConvBenchmarkOptions& options, double peak) {
  ConvLayer layer(shape, options.precision);
  const Timing timing = time_repeats(options.common, [&] { layer.run(); });
  const double gflops = layer.gflop() / timing.median;
  return {{"name", shape.name},     {"channels", shape.channels},     {"outputs", shape.outputs},
          {"height", shape.height}, {"width", shape.width},           {"kernel", shape.kernel},
          {"stride", shape.stride}, {"times", shape.times},           {"algorithm", layer.algorithm()},
          {"gflop", layer.gflop()}, {"seconds", timing.median},       {"spread", timing.spread()},
          {"gflops", gflops},       {"share_of_peak", gflops / peak}, {"mb_moved", layer.mb_moved()}};
}

void bench_conv(const ConvBenchmarkOptions& options) {
  std::vector<ConvShape> shapes;
  if (!options.one.empty()) {
    shapes.push_back(parse_shape(options.one));
  } else {
    const ConvShape size = parse_shape("1,1," + options.size + ",1,1");
    shapes = network_shapes(size.height / 32 * 32, size.width / 32 * 32);
  }
  nn::require(options.precision);
  const double peak = peak_gflops();
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  if (!options.common.json) {
    print_machine(peak);
    fmt::print("{:<20} {:>4} {:>4} {:>9} {:<8} {:>7} {:>8} {:>7} {:>9} {:>7} {:>7}\n", "layer", "in", "out",
               "input", "method", "GFLOP", "ms", "spread", "GFLOP/s", "of peak", "MB");
  }
  double seconds = 0.0, gflop = 0.0;
  for (const ConvShape& shape : shapes) {
    const nlohmann::ordered_json row = run(shape, options, peak);
    rows.push_back(row);
    seconds += shape.times * row["seconds"].get<double>();
    gflop += shape.times * row["gflop"].get<double>();
    if (options.common.json) continue;
    fmt::print("{:<20} {:>4} {:>4} {:>9} {:<8} {:>7.3f} {:>8.3f} {:>6.0f}% {:>9.1f} {:>6.1f}% {:>7.1f}\n",
               shape.name, shape.channels, shape.outputs, fmt::format("{}x{}", shape.width, shape.height),
               row["algorithm"].get<std::string>(), row["gflop"].get<double>(),
               row["seconds"].get<double>() * 1e3, row["spread"].get<double>() * 100,
               row["gflops"].get<double>(), row["share_of_peak"].get<double>() * 100,
               row["mb_moved"].get<double>());
  }
  if (options.common.json) {
    nlohmann::ordered_json result = machine_json(peak);
    result["precision"] = to_string(options.precision);
    result["layers"] = rows;
    result["backbone_fpn_seconds"] = seconds;
    result["backbone_fpn_gflop"] = gflop;
    fmt::print("{}\n", result.dump(1));
  } else if (options.one.empty()) {
    fmt::print("backbone and pyramid: {:.1f} GFLOP in {:.1f} ms, {:.2f} x peak\n", gflop, seconds * 1e3,
               gflop / seconds / peak);
  }
}

}  // namespace

void add_conv_benchmark(CLI::App& bench) {
  auto options = std::make_shared<ConvBenchmarkOptions>();
  CLI::App* command = bench.add_subcommand("conv", "The convolutions of Mask R-CNN R50-FPN, one by one");
  command->add_option("--size", options->size, "network input, WIDTHxHEIGHT; multiples of 32")
      ->capture_default_str();
  command->add_option("--shape", options->one,
                      "one layer instead: CHANNELS,OUTPUTS,WIDTHxHEIGHT,KERNEL,STRIDE of its input");
  command
      ->add_option_function<std::string>(
          "--precision",
          [options](const std::string& name) { options->precision = nn::precision_from_name(name); },
          "numbers that are multiplied: f32, bf16 or int8 [f32]")
      ->check(CLI::IsMember({"f32", "bf16", "int8"}));
  add_benchmark_options(command, options->common);
  command->footer(
      "Examples:\n"
      "  penumbra bench conv --threads 1\n"
      "  penumbra bench conv --shape 256,256,336x104,3,1 --isa avx2\n"
      "  penumbra bench conv --precision int8\n"
      "GFLOP are those of the direct convolution, whatever the method: Winograd's may pass the peak, which "
      "is of f32.");
  command->callback([options] { bench_conv(*options); });
}

}  // namespace penumbra::apps
