// penumbra bench conv: every convolution shape of Mask R-CNN R50-FPN, or one of your own.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/bench/benchmark.h"
#include "nn/base/counter_random.h"
#include "nn/base/error.h"
#include "nn/layers/conv2d.h"

namespace penumbra::apps {

namespace {

struct ConvShape {
  std::string name;
  int images, channels, outputs, height, width;  // of the input
  int kernel, stride;
  bool residual = false;
  int times = 1;  // in backbone and pyramid
};

// The layers of ResNet-50 and its pyramid for a network input of height x width.
std::vector<ConvShape> network_shapes(int height, int width) {
  std::vector<ConvShape> shapes;
  const int blocks[] = {3, 4, 6, 3};
  shapes.push_back({"stem 7x7", 1, 3, 64, height, width, 7, 2});
  int inputs = 64;
  for (int stage = 0; stage < 4; ++stage) {
    const int h = height >> (2 + stage), w = width >> (2 + stage), middle = 64 << stage, outputs = 4 * middle;
    const int n = blocks[stage], s = stage == 0 ? 1 : 2;  // the stage's first block halves the map
    const std::string res = fmt::format("res{}", stage + 2);
    shapes.push_back({res + " first 1x1", 1, inputs, middle, h * s, w * s, 1, 1});
    if (s == 2) shapes.push_back({res + " 3x3 /2", 1, middle, middle, h * s, w * s, 3, 2});
    shapes.push_back({res + " shortcut 1x1", 1, inputs, outputs, h * s, w * s, 1, s});
    shapes.push_back({res + " 1x1 reduce", 1, outputs, middle, h, w, 1, 1, false, n - 1});
    shapes.push_back({res + " 3x3", 1, middle, middle, h, w, 3, 1, false, s == 2 ? n - 1 : n});
    shapes.push_back({res + " 1x1 expand", 1, middle, outputs, h, w, 1, 1, true, n});
    inputs = outputs;
  }
  for (int level = 2; level <= 5; ++level) {
    const int h = height >> level, w = width >> level;
    shapes.push_back({fmt::format("P{} lateral 1x1", level), 1, 64 << level, 256, h, w, 1, 1});
    shapes.push_back({fmt::format("P{} output 3x3", level), 1, 256, 256, h, w, 3, 1});
  }
  shapes.push_back({"mask head 3x3", 16, 256, 256, 14, 14, 3, 1, false, 0});
  shapes.push_back({"box head fc6", 500, 256, 1024, 7, 7, 7, 1, false, 0});
  return shapes;
}

struct ConvBenchmarkOptions {
  BenchmarkOptions common;
  std::string size = "1344x416", one;
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

nn::Tensor random_weight(const ConvShape& shape) {
  nn::Tensor weight({shape.outputs, shape.channels, shape.kernel, shape.kernel});
  for (std::size_t i = 0; i < weight.values.size(); ++i) {
    weight.values[i] = 0.05F * counter_uniform_f32(1, static_cast<std::uint32_t>(i));
  }
  return weight;
}

void fill(nn::FeatureMap& map) {
  std::uint32_t i = 0;
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      for (int y = 0; y < map.height(); ++y) {
        float* pixels = map.pixel(n, b, y, 0);
        for (int x = 0; x < map.width() * map.block(); ++x) pixels[x] = counter_uniform_f32(2, i++);
      }
    }
  }
}

nlohmann::ordered_json run(const ConvShape& shape, const BenchmarkOptions& options, double peak) {
  nn::Conv2dOptions conv_options;
  conv_options.stride = shape.stride;
  const bool fully_connected = shape.kernel == shape.height && shape.kernel == shape.width;
  conv_options.padding = fully_connected ? 0 : shape.kernel / 2;
  conv_options.activation = nn::Activation::relu;
  const int block = shape.channels <= nn::kImageBlock ? nn::kImageBlock : nn::kBlock;
  const nn::Conv2d conv(random_weight(shape), {}, conv_options, block);

  nn::Arena arena;
  nn::FeatureMap input(arena, shape.images, shape.channels, shape.height, shape.width, conv_options.padding,
                       block);
  fill(input);
  nn::FeatureMap residual;
  double outputs = 0.0;  // values
  const int key = 0;
  Timing timing;
  {
    const nn::FeatureMap output = conv(input, arena);
    outputs = static_cast<double>(output.images()) * output.channels() * output.height() * output.width();
    if (shape.residual) {
      residual = nn::FeatureMap(arena, shape.images, shape.outputs, output.height(), output.width(), 0);
      fill(residual);
    }
  }
  timing = time_repeats(options, [&] {
    const nn::Arena::Pass pass(arena, &key, shape.height, shape.width);
    conv(input, arena, 0, shape.residual ? &residual : nullptr);
  });
  const double inputs = static_cast<double>(shape.images) * shape.channels * shape.height * shape.width;
  const double weights = static_cast<double>(shape.outputs) * shape.channels * shape.kernel * shape.kernel;
  const double gflop = 2e-9 * shape.images * conv.multiply_adds(shape.height, shape.width);
  const double gflops = gflop / timing.median;
  return {{"name", shape.name},
          {"channels", shape.channels},
          {"outputs", shape.outputs},
          {"height", shape.height},
          {"width", shape.width},
          {"kernel", shape.kernel},
          {"stride", shape.stride},
          {"times", shape.times},
          {"algorithm", conv.algorithm()},
          {"gflop", gflop},
          {"seconds", timing.median},
          {"spread", timing.spread()},
          {"gflops", gflops},
          {"share_of_peak", gflops / peak},
          {"mb_moved", 4e-6 * (inputs + weights + outputs * (shape.residual ? 2.0 : 1.0))}};
}

void bench_conv(const ConvBenchmarkOptions& options) {
  std::vector<ConvShape> shapes;
  if (!options.one.empty()) {
    shapes.push_back(parse_shape(options.one));
  } else {
    const ConvShape size = parse_shape("1,1," + options.size + ",1,1");
    shapes = network_shapes(size.height / 32 * 32, size.width / 32 * 32);
  }
  const double peak = peak_gflops();
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  if (!options.common.json) {
    print_machine(peak);
    fmt::print("{:<20} {:>4} {:>4} {:>9} {:<8} {:>7} {:>8} {:>7} {:>9} {:>7} {:>7}\n", "layer", "in", "out",
               "input", "method", "GFLOP", "ms", "spread", "GFLOP/s", "of peak", "MB");
  }
  double seconds = 0.0, gflop = 0.0;
  for (const ConvShape& shape : shapes) {
    const nlohmann::ordered_json row = run(shape, options.common, peak);
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
  add_benchmark_options(command, options->common);
  command->footer(
      "Examples:\n"
      "  penumbra bench conv --threads 1\n"
      "  penumbra bench conv --shape 256,256,336x104,3,1 --isa avx2\n"
      "GFLOP are those of the direct convolution, whatever the method: Winograd's may pass the peak.");
  command->callback([options] { bench_conv(*options); });
}

}  // namespace penumbra::apps
