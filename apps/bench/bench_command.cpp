// penumbra bench: how fast the parts are, as a share of what the machine can do.
#include "apps/bench/benchmark.h"
#include "apps/common/commands.h"

namespace penumbra::apps {

void add_bench_command(CLI::App& app) {
  CLI::App* bench =
      app.add_subcommand("bench", "Measure speed, as a share of the machine's peak; accuracy of the SLAM");
  bench->require_subcommand(1);
  add_peak_benchmark(*bench);
  add_conv_benchmark(*bench);
  add_layers_benchmark(*bench);
  add_network_benchmark(*bench);
  add_detectors_benchmark(*bench);
  add_image_benchmark(*bench);
  add_depth_masks_benchmark(*bench);
  add_slam_benchmark(*bench);
  add_dynamics_benchmark(*bench);
  add_brain_benchmark(*bench);
  bench->footer(
      "Examples:\n"
      "  penumbra bench peak --threads 1\n"
      "  penumbra bench image\n"
      "  penumbra bench network --size 1242x375 --detections 100 --json\n"
      "  penumbra bench dynamics --weights weights_tools/models/penumbra-office.safetensors --out "
      "out/dynamics\n"
      "  penumbra bench slam DATA --streets out/streets --out out/bench\n"
      "Run `penumbra bench NAME --help` for a benchmark's options. Leave the machine alone meanwhile.");
}

}  // namespace penumbra::apps
