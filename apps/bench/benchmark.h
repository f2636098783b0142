// What the benchmarks share: options, timing, and the peak that rates are compared with.
//
// Every figure is the median of some repeats after a warm-up; "spread" is (slowest - fastest) / median. Rates
// are given as a share of the peak loop, register-only multiply-adds on the same threads, measured in the
// same run: the share says how good a kernel is, whatever the machine and its clock.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "nn/image/image.h"

namespace penumbra::apps {

struct BenchmarkOptions {
  int repeats = 7;
  int warm_up = 2;
  bool json = false;
};

// Adds --repeats, --warm-up, --json, --threads and --isa.
void add_benchmark_options(CLI::App* command, BenchmarkOptions& options);

struct Timing {
  double median = 0.0, fastest = 0.0, slowest = 0.0;  // seconds
  double spread() const { return median > 0.0 ? (slowest - fastest) / median : 0.0; }
};

// Calls `work` warm_up + repeats times and times the repeats.
Timing time_repeats(const BenchmarkOptions& options, const std::function<void()>& work);

// An image of noise, three channels. Throws UsageError where `size`, the option --size, is no WIDTHxHEIGHT up
// to 8192.
ByteImage noise_image(const std::string& size);

// GFLOP/s of the peak loop, all threads together; a multiply-add counts as two operations.
double peak_gflops();

// Instruction set, threads and peak: what every result begins with. `peak` is peak_gflops().
nlohmann::ordered_json machine_json(double peak);
// The same as a line for people.
void print_machine(double peak);

// One function a benchmark, each adds its subcommand to `penumbra bench`.
void add_peak_benchmark(CLI::App& bench);
void add_conv_benchmark(CLI::App& bench);
void add_layers_benchmark(CLI::App& bench);
void add_network_benchmark(CLI::App& bench);
void add_detectors_benchmark(CLI::App& bench);
void add_image_benchmark(CLI::App& bench);
void add_depth_masks_benchmark(CLI::App& bench);
void add_slam_benchmark(CLI::App& bench);

}  // namespace penumbra::apps
