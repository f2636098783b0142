#include "apps/network/loaded_network.h"

#include "nn/models/class_names.h"

namespace penumbra::apps {

LoadedNetwork network_of(const nn::StateDict& weights, const std::filesystem::path& source,
                         const std::filesystem::path& classes, const nn::NetworkConfig& config) {
  LoadedNetwork loaded;
  loaded.source = source.string();
  loaded.network = nn::make_network(weights, config);
  loaded.names =
      nn::class_names(weights, loaded.network->classes(), classes, loaded.network->has_background());
  return loaded;
}

}  // namespace penumbra::apps
