#include "apps/bench/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <vector>

#include "apps/common/compute_options.h"
#include "apps/common/image_size.h"
#include "nn/base/counter_random.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/simd/isa.h"
#include "nn/simd/kernel_table.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::apps {

namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void add_benchmark_options(CLI::App* command, BenchmarkOptions& options) {
  command->add_option("--repeats", options.repeats, "timed runs, of which the median counts")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  command->add_option("--warm-up", options.warm_up, "runs before them")
      ->capture_default_str()
      ->check(CLI::Range(0, 10000));
  command->add_flag("--json", options.json, "print JSON");
  add_threads_option(command);
  add_isa_option(command);
}

Timing time_repeats(const BenchmarkOptions& options, const std::function<void()>& work) {
  for (int i = 0; i < options.warm_up; ++i) work();
  std::vector<double> seconds(static_cast<std::size_t>(options.repeats));
  for (double& s : seconds) s = seconds_of(work);
  std::sort(seconds.begin(), seconds.end());
  return {seconds[seconds.size() / 2], seconds.front(), seconds.back()};
}

ByteImage noise_image(const std::string& size) {
  const std::optional<Size> pixels = parse_image_size(size);
  if (!pixels || pixels->width < 1 || pixels->height < 1 || pixels->width > 8192 || pixels->height > 8192) {
    throw UsageError("--size: expected WIDTHxHEIGHT up to 8192, found '" + size + "'");
  }
  ByteImage image(pixels->width, pixels->height, 3);
  for (std::uint32_t i = 0; i < image.elements(); ++i) {
    image.data()[i] = static_cast<std::uint8_t>(127.5F + 127.0F * counter_uniform_f32(1, i));
  }
  return image;
}

double peak_gflops() {
  constexpr long kIterations = 2'000'000;
  constexpr int kRuns = 5;  // the best counts: the peak is what the processor can do
  const nn::KernelTable& kernels = nn::kernels();
  double best = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::atomic<double> operations{0.0};
    const double seconds = seconds_of(
        [&] { parallel_for(thread_count(), 1, [&](int) { operations += kernels.peak_loop(kIterations); }); });
    best = std::max(best, operations / seconds * 1e-9);
  }
  return best;
}

double peak_tile_gflops(nn::Precision precision) {
  constexpr long kIterations = 5'000;  // 80 microseconds on a tile unit
  constexpr int kRuns = 5;
  double best = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::atomic<double> operations{0.0};
    const double seconds = seconds_of([&] {
      parallel_for(thread_count(), 1,
                   [&](int) { operations += nn::tile_unit()->peak_loop(precision, kIterations); });
    });
    best = std::max(best, operations / seconds * 1e-9);
  }
  return best;
}

nlohmann::ordered_json machine_json(double peak) {
  nlohmann::ordered_json machine{
      {"isa", nn::to_string(nn::current_isa())}, {"threads", thread_count()}, {"peak_gflops", peak}};
  if (nn::tile_unit() != nullptr) {
    machine["peak_tile_gflops"] = {{"bf16", peak_tile_gflops(nn::Precision::bf16)},
                                   {"int8", peak_tile_gflops(nn::Precision::int8)}};
  }
  return machine;
}

void print_machine(double peak) {
  fmt::print("{}, {} thread{}, peak {:.1f} GFLOP/s\n", nn::to_string(nn::current_isa()), thread_count(),
             thread_count() == 1 ? "" : "s", peak);
  if (nn::tile_unit() != nullptr) {
    fmt::print("tile unit, peak {:.1f} GFLOP/s in bf16, {:.1f} in int8\n",
               peak_tile_gflops(nn::Precision::bf16), peak_tile_gflops(nn::Precision::int8));
  }
}

}  // namespace penumbra::apps
