#include "apps/network/load_network.h"

#include "apps/common/log.h"
#include "nn/base/text.h"
#include "nn/models/class_names.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

nn::StateDict load_noted_weights(const std::filesystem::path& path, const std::string& key) {
  nn::StateDict weights = weights_tools::load_weights(path, key);
  for (const std::string& note : weights.notes) log_info("{}: {}", printable(weights.source, 400), note);
  return weights;
}

void add_key_option(CLI::App* command, std::string& key) {
  command->add_option("--key", key,
                      "where in a checkpoint the weights are, such as model or ema (default: what fits)");
}

LoadedNetwork load_network(const std::filesystem::path& path, const std::filesystem::path& classes,
                           const nn::NetworkConfig& config, const std::string& key) {
  const nn::StateDict weights = load_noted_weights(path, key);
  LoadedNetwork loaded;
  loaded.source = path.string();
  loaded.network = nn::make_network(weights, config);
  loaded.names =
      nn::class_names(weights, loaded.network->classes(), classes, loaded.network->has_background());
  return loaded;
}

}  // namespace penumbra::apps
