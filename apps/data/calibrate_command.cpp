// penumbra calibrate: the ranges of every layer's inputs, without which a
// network cannot run in int8.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/log.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "nn/models/make_network.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

struct CalibrateOptions {
  std::vector<std::string> images;
  std::string weights, output;
};

void calibrate(const CalibrateOptions& options) {
  std::error_code ignored;  // where the output does not exist yet
  if (std::filesystem::equivalent(options.weights, options.output, ignored)) {
    throw UsageError(fmt::format("--output: {} is the input itself", options.output));
  }
  nn::StateDict weights = weights_tools::load_weights(options.weights);
  nn::InputRanges ranges;
  nn::NetworkConfig config;
  config.mask_rcnn.precision.observed = config.yolov5.precision.observed = &ranges;
  const std::unique_ptr<nn::InstanceSegmenter> network = nn::make_network(weights, config);
  nn::Arena arena;
  for (const std::string& path : options.images) {
    network->detect(nn::read_image(path, nn::ImageColour::bgr, nn::ImageOrientation::upright), arena);
    log_info("{}: done", path);
  }
  nn::store_input_ranges(ranges, weights);
  nn::write_safetensors(options.output, weights);
  fmt::print("{} -> {}: input ranges of {} from {}\n", options.weights, options.output,
             counted(ranges.size(), "layer"), counted(options.images.size(), "image"));
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = app.add_subcommand("calibrate", "Prepare weights for --precision int8");
  command->add_option("images", options->images, "images of the kind that the network will see")->required();
  command
      ->add_option("--weights", options->weights, "Mask R-CNN, YOLOv5 or AFNET weights: safetensors or .pth")
      ->required();
  command->add_option("-o,--output", options->output, "safetensors file to write: the weights and the ranges")
      ->required();
  add_threads_option(command);
  add_isa_option(command);
  command->footer(
      "The network runs in f32; the range of every layer's inputs goes into the file's metadata. 10 to 50 "
      "images\n"
      "are enough.\n\n"
      "Examples:\n"
      "  penumbra calibrate street/*.png --weights maskrcnn.safetensors -o maskrcnn_int8.safetensors\n"
      "  penumbra segment photo.jpg --weights maskrcnn_int8.safetensors --precision int8 --out out/found\n");
  command->callback([options] { calibrate(*options); });
}

}  // namespace penumbra::apps
