// penumbra bench image: the operations on images, one by one.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "apps/bench/benchmark.h"
#include "apps/bench/image_operations.h"
#include "apps/common/image_size.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "nn/simd/isa.h"

namespace penumbra::apps {

namespace {

struct ImageBenchmarkOptions {
  BenchmarkOptions common;
  std::string size = "1241x376", image;
};

ByteImage image_of(const ImageBenchmarkOptions& options) {
  constexpr int kLeast = 16;  // pixels a side
  if (!options.image.empty()) {
    ByteImage image = nn::read_image(options.image, nn::ImageColour::grey);
    if (std::min(image.width(), image.height()) >= kLeast) return image;
    throw InputError(options.image, fmt::format("an image of {} pixels a side or more", kLeast),
                     fmt::format("{} x {}", image.width(), image.height()));
  }
  const std::optional<Size> size = parse_image_size(options.size);
  if (!size || std::min(size->width, size->height) < kLeast) {
    throw UsageError(
        fmt::format("--size: expected WIDTHxHEIGHT, {} or more each, found '{}'", kLeast, options.size));
  }
  return benchmark_image(size->width, size->height);
}

void bench_image(const ImageBenchmarkOptions& options) {
  const ByteImage image = image_of(options);
  const double megapixels = 1e-6 * static_cast<double>(image.elements());
  nlohmann::ordered_json result{{"isa", to_string(nn::current_isa())},
                                {"width", image.width()},
                                {"height", image.height()},
                                {"operations", nlohmann::ordered_json::array()}};
  if (!options.common.json) {
    fmt::print("{}, one thread, {} x {} pixels\n", to_string(nn::current_isa()), image.width(),
               image.height());
    fmt::print("{:<24} {:>8} {:>7} {:>12}\n", "operation", "ms", "spread", "Mpixels/s");
  }
  for (const ImageOperation& operation : image_operations(image)) {
    const Timing timing = time_repeats(options.common, operation.run);
    const double rate = megapixels / timing.median;
    result["operations"].push_back({{"name", operation.name},
                                    {"seconds", timing.median},
                                    {"spread", timing.spread()},
                                    {"megapixels_per_second", rate}});
    if (options.common.json) continue;
    fmt::print("{:<24} {:>8.3f} {:>6.0f}% {:>12.0f}\n", operation.name, timing.median * 1e3,
               timing.spread() * 100, rate);
  }
  if (options.common.json) fmt::print("{}\n", result.dump(1));
}

}  // namespace

void add_image_benchmark(CLI::App& bench) {
  auto options = std::make_shared<ImageBenchmarkOptions>();
  options->common.repeats = 41;
  CLI::App* command =
      bench.add_subcommand("image", "Corners, blur, resize, remap and grey of one image, on one thread");
  command->add_option("--size", options->size, "of an image that is made up, WIDTHxHEIGHT")
      ->capture_default_str();
  command->add_option("--image", options->image, "an image file instead");
  add_benchmark_options(command, options->common);
  command->footer(
      "Examples:\n"
      "  penumbra bench image\n"
      "  penumbra bench image --image kitti/sequences/00/image_0/000000.png --isa avx2\n"
      "The same beside OpenCV's functions: the build target bench_image_opencv (docs/benchmarks.md).");
  command->callback([options] { bench_image(*options); });
}

}  // namespace penumbra::apps
