// penumbra convert: any checkpoint that Penumbra reads to safetensors.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/log.h"
#include "apps/network/load_network.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/nearest_word.h"
#include "nn/base/text.h"
#include "nn/io/safetensors.h"
#include "nn/models/weight_metadata.h"
#include "weights_tools/convert_floats.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

struct ConvertOptions {
  std::string input, output, key, dtype = "keep";
  std::vector<std::string> metadata;  // "key=value"
};

void add_metadata(const std::vector<std::string>& settings, nn::StateDict& state) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("--metadata: expected KEY=VALUE, found '{}'", printable(setting)));
    }
    const std::string key = setting.substr(0, equals);
    const std::string meant = suggestion(key, nn::kMetadataKeys);
    if (std::find(std::begin(nn::kMetadataKeys), std::end(nn::kMetadataKeys), key) ==
            std::end(nn::kMetadataKeys) &&
        !meant.empty()) {
      throw UsageError(fmt::format("--metadata {}: no key of Penumbra's{}", printable(key), meant));
    }
    state.metadata[key] = setting.substr(equals + 1);
  }
}

void convert(const ConvertOptions& options) {
  std::error_code ignored;  // where the output does not exist yet
  if (std::filesystem::equivalent(options.input, options.output, ignored)) {
    throw UsageError(fmt::format("--output: {} is the input itself", options.output));
  }
  const weights_tools::CheckpointFormat format = weights_tools::checkpoint_format(options.input);
  nn::StateDict state = load_noted_weights(options.input, options.key);

  const std::vector<std::string> left_out = weights_tools::leave_out_unwritable(state);
  if (!left_out.empty()) {
    log_warning("left out: {} of C128, which safetensors does not have: {}{}",
                counted(left_out.size(), "tensor"), printable(left_out.front()),
                left_out.size() > 1 ? ", ..." : "");
  }
  if (state.tensors.empty()) throw InputError(options.input, "tensors that safetensors can hold", "none");

  std::size_t converted = 0, batch_norms = 0;
  if (options.dtype != "keep") {
    const nn::DataType type = options.dtype == "f16" ? nn::DataType::f16 : nn::DataType::f32;
    weights_tools::FloatConversion conversion = weights_tools::convert_floats(state, type);
    if (!conversion.out_of_range.empty()) {
      log_warning("kept in f32, for their values lie beyond the range of {}: {}: {}{}", options.dtype,
                  counted(conversion.out_of_range.size(), "tensor"),
                  printable(conversion.out_of_range.front()),
                  conversion.out_of_range.size() > 1 ? ", ..." : "");
    }
    state = std::move(conversion.state);
    converted = conversion.converted;
    batch_norms = conversion.batch_norms;
  }
  // A file that was converted before keeps the format that it first came from.
  state.metadata.try_emplace("source_format", to_string(format));
  add_metadata(options.metadata, state);
  // A wrong number is noticed now, not when the weights are used.
  nn::metadata_number(state, "batch_norm_eps", {0.0, 1.0});
  for (const char* key :
       {"min_size", "max_size", "box_head_layers", "mask_head_layers", "rpn_candidates", "rpn_proposals"})
    nn::metadata_integer(state, key, {1.0, 1e6});
  nn::write_safetensors(options.output, state);

  fmt::print("{} ({}) -> {}: {}, {} converted to {}{}, {} bytes\n", options.input, to_string(format),
             options.output, counted(state.tensors.size(), "tensor"), converted,
             options.dtype == "keep" ? "nothing" : options.dtype,
             batch_norms == 0 ? "" : fmt::format(" ({} of batch norms stay f32)", batch_norms),
             std::filesystem::file_size(options.output));
}

}  // namespace

void add_convert_command(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = app.add_subcommand("convert", "Convert a PyTorch checkpoint to safetensors");
  command
      ->add_option(
          "input", options->input,
          "checkpoint: .pt or .pth (state dict, training checkpoint or whole network) or .safetensors")
      ->required();
  command->add_option("-o,--output", options->output, "safetensors file to write")->required();
  add_key_option(command, options->key);
  command
      ->add_option("--dtype", options->dtype,
                   "element type for floating-point tensors; integers stay, and f32 what f16 cannot hold")
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
      "  penumbra convert yolov5s.pt -o yolov5s.safetensors\n"
      "  penumbra convert maskrcnn.pth -o maskrcnn.safetensors\n"
      "  penumbra convert maskrcnn_resnet50_fpn_coco.pth -o coco.safetensors --dtype f16 \\\n"
      "                   --metadata batch_norm_eps=0\n");
  command->callback([options] { convert(*options); });
}

}  // namespace penumbra::apps
