// penumbra convert: any checkpoint that Penumbra reads to safetensors.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/safetensors.h"
#include "weights_tools/convert_floats.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

struct ConvertOptions {
  std::string input, output, dtype = "keep";
  std::vector<std::string> metadata;  // "key=value"
};

void add_metadata(const std::vector<std::string>& settings, nn::StateDict& state) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("--metadata: expected KEY=VALUE, found '{}'", printable(setting)));
    }
    state.metadata[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
}

void convert(const ConvertOptions& options) {
  std::error_code ignored;  // where the output does not exist yet
  if (std::filesystem::equivalent(options.input, options.output, ignored)) {
    throw UsageError(fmt::format("--output: {} is the input itself", options.output));
  }
  const weights_tools::CheckpointFormat format = weights_tools::checkpoint_format(options.input);
  nn::StateDict state = weights_tools::load_weights(options.input);

  std::size_t converted = 0;
  if (options.dtype != "keep") {
    const nn::DataType type = options.dtype == "f16" ? nn::DataType::f16 : nn::DataType::f32;
    weights_tools::FloatConversion conversion = weights_tools::convert_floats(state, type);
    for (const std::string& name : conversion.out_of_range) {
      spdlog::warn("{}: values beyond the range of {} became infinite", printable(name), options.dtype);
    }
    state = std::move(conversion.state);
    converted = conversion.converted;
  }
  // A file that was converted before keeps the format that it first came from.
  state.metadata.try_emplace("source_format", to_string(format));
  add_metadata(options.metadata, state);
  nn::write_safetensors(options.output, state);

  fmt::print("{} ({}) -> {}: {} tensors, {} converted to {}, {} bytes\n", options.input, to_string(format),
             options.output, state.tensors.size(), converted,
             options.dtype == "keep" ? "nothing" : options.dtype, std::filesystem::file_size(options.output));
}

}  // namespace

void add_convert_command(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = app.add_subcommand("convert", "Convert a PyTorch checkpoint to safetensors");
  command->add_option("input", options->input, "checkpoint: .pth (zip or legacy format) or .safetensors")
      ->required();
  command->add_option("-o,--output", options->output, "safetensors file to write")->required();
  command->add_option("--dtype", options->dtype, "element type for floating-point tensors; integers stay")
      ->check(CLI::IsMember({"f32", "f16", "keep"}))
      ->capture_default_str();
  command
      ->add_option("--metadata", options->metadata,
                   "KEY=VALUE to record in the file, such as batch_norm_eps=0")
      ->expected(1)
      ->take_all();
  command->footer(
      "The checkpoint is read without Python, and nothing in it is executed.\n\n"
      "Examples:\n"
      "  penumbra convert maskrcnn.pth -o maskrcnn.safetensors\n"
      "  penumbra convert maskrcnn_resnet50_fpn_coco.pth -o coco.safetensors --dtype f16 \\\n"
      "                   --metadata batch_norm_eps=0\n");
  command->callback([options] { convert(*options); });
}

}  // namespace penumbra::apps
