#include "apps/load_network.h"

#include "nn/models/class_names.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

LoadedNetwork load_network(const std::filesystem::path& path, const std::filesystem::path& classes,
                           const nn::NetworkConfig& config) {
  const nn::StateDict weights = weights_tools::load_weights(path);
  LoadedNetwork loaded;
  loaded.source = path.string();
  loaded.network = nn::make_network(weights, config);
  loaded.names = nn::class_names(weights, loaded.network->classes(), classes);
  return loaded;
}

}  // namespace penumbra::apps
