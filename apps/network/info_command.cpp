// penumbra info: what a checkpoint or a recording holds, or what this machine can do.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/network/load_network.h"
#include "apps/network/recording_info.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/base/text.h"
#include "nn/models/layer_precision.h"
#include "nn/simd/amx_permission.h"
#include "nn/simd/kernel_table.h"
#include "nn/simd/low_precision.h"
#include "slam/sources/bag/chunk_packing.h"
#include "slam/sources/bag/message_source.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

struct InfoOptions {
  std::string file, key;
  bool json = false, cpu = false;
};

struct Totals {
  std::int64_t elements = 0;
  std::size_t bytes = 0;
};

Totals total(const nn::StateDict& state) {
  Totals totals;
  for (const auto& [name, tensor] : state.tensors) {
    totals.elements += tensor.elements();
    totals.bytes += tensor.bytes.size();
  }
  return totals;
}

void print_json(const nn::StateDict& state, const char* format) {
  nlohmann::ordered_json tensors = nlohmann::ordered_json::array();
  for (const auto& [name, tensor] : state.tensors) {
    tensors.push_back({{"name", name},
                       {"dtype", to_string(tensor.type)},
                       {"shape", tensor.shape},
                       {"bytes", tensor.bytes.size()}});
  }
  const Totals totals = total(state);
  const nlohmann::ordered_json info = {{"file", printable(state.source, state.source.size())},
                                       {"format", format},
                                       {"elements", totals.elements},
                                       {"bytes", totals.bytes},
                                       {"metadata", state.metadata},
                                       {"tensors", tensors}};
  fmt::print("{}\n", info.dump(2));
}

void print_table(const nn::StateDict& state, const char* format) {
  std::size_t name_width = 4, shape_width = 5;
  for (const auto& [name, tensor] : state.tensors) {
    name_width = std::max(name_width, printable(name).size());
    shape_width = std::max(shape_width, fmt::format("[{}]", fmt::join(tensor.shape, ", ")).size());
  }
  fmt::print("{:<{}}  {:<5}  {:<{}}  {:>10}\n", "name", name_width, "dtype", "shape", shape_width, "bytes");
  for (const auto& [name, tensor] : state.tensors) {
    fmt::print("{:<{}}  {:<5}  {:<{}}  {:>10}\n", printable(name), name_width, to_string(tensor.type),
               fmt::format("[{}]", fmt::join(tensor.shape, ", ")), shape_width, tensor.bytes.size());
  }
  for (const auto& [key, value] : state.metadata) {
    fmt::print("metadata: {} = {}\n", printable(key), printable(value, 400));
  }
  const Totals totals = total(state);
  fmt::print("{}: {}, {}, {}, {} bytes\n", printable(state.source, 400), format,
             counted(state.tensors.size(), "tensor"), counted(totals.elements, "element"), totals.bytes);
}

void show_cpu(bool json) {
  nlohmann::ordered_json isas = nlohmann::ordered_json::object(),
                         precisions = nlohmann::ordered_json::object();
  for (const nn::Isa isa : nn::kIsas) isas[nn::to_string(isa)] = nn::is_supported(isa);
  for (const nn::Precision precision : {nn::Precision::f32, nn::Precision::bf16, nn::Precision::int8}) {
    precisions[nn::to_string(precision)] = nn::is_supported(precision);
  }
  const std::string amx = describe(nn::amx_state());
  const bool has_bf16 = nn::is_supported(nn::Precision::bf16);
  const std::string bf16 = has_bf16 ? to_string(nn::bf16_arithmetic()) : "none";
  // What `--precision auto` takes for weights without input ranges.
  nn::LayerPrecision automatic;
  automatic.automatic = true;
  const std::string choice = to_string(automatic.resolved({}).precision);
  const nn::TileKernels& tile = *nn::kernels().tile;
  const std::string chosen = nn::to_string(nn::current_isa());
  nlohmann::ordered_json libraries = nlohmann::ordered_json::object();
  for (const slam::BagLibrary& library : slam::bag_libraries()) libraries[library.name] = library.is_there;
  if (json) {
    const nlohmann::ordered_json info = {{"isa", chosen},
                                         {"tile_pixels", tile.pixels},
                                         {"tile_channels", tile.channels},
                                         {"threads", thread_count()},
                                         {"supported_isas", isas},
                                         {"supported_precisions", precisions},
                                         {"amx", amx},
                                         {"bf16", bf16},
                                         {"recordings", libraries},
                                         {"precision_auto", choice}};
    fmt::print("{}\n", info.dump(2));
    return;
  }
  fmt::print("instruction set {}, register tile of {} pixels x {} channels, {} threads\n", chosen,
             tile.pixels, tile.channels, thread_count());
  for (const auto& [title, table] : {std::pair("instruction sets", isas), std::pair("precisions", precisions),
                                     std::pair("unpacks recordings of", libraries)}) {
    fmt::print("{}:", title);
    for (const auto& [name, supported] : table.items()) fmt::print(" {} {}", name, supported ? "yes" : "no");
    fmt::print("\n");
  }
  fmt::print("tile unit (AMX): {}\n", amx);
  if (has_bf16) fmt::print("bf16 multiplies by {}\n", bf16);
  fmt::print("--precision auto takes {} (calibrated weights: int8 where there is int8)\n", choice);
}

void show_info(const InfoOptions& options) {
  if (options.cpu == !options.file.empty()) throw UsageError("info: expected either a file or --cpu");
  if (options.cpu) {
    show_cpu(options.json);
    return;
  }
  if (slam::looks_like_bag(options.file)) {
    show_recording(options.file, options.json);
    return;
  }
  const weights_tools::CheckpointFormat format = weights_tools::checkpoint_format(options.file);
  const nn::StateDict state = load_noted_weights(options.file, options.key);
  if (options.json) {
    print_json(state, to_string(format));
  } else {
    print_table(state, to_string(format));
  }
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand(
      "info", "List the tensors of a checkpoint, the topics of a recording, or what this machine can do");
  command->add_option("file", options->file,
                      "checkpoint: .safetensors, .pt or .pth; or a recording: .bag, .mcap, .db3");
  add_key_option(command, options->key);
  command->add_flag("--cpu", options->cpu,
                    "instead: the instruction set in use, what else this machine can do, and which "
                    "recordings this build unpacks");
  command->add_flag("--json", options->json, "print JSON");
  command->footer(
      "Examples:\n"
      "  penumbra info maskrcnn.pth\n"
      "  penumbra info maskrcnn.safetensors --json\n"
      "  penumbra info run.bag\n"
      "  penumbra info --cpu\n");
  add_isa_option(command);
  command->callback([options] { show_info(*options); });
}

}  // namespace penumbra::apps
