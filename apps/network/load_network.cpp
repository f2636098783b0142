#include "apps/network/load_network.h"

#include "apps/common/log.h"
#include "nn/base/text.h"
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
  return network_of(load_noted_weights(path, key), path, classes, config);
}

}  // namespace penumbra::apps
