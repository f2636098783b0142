#include "apps/network/loaded_network.h"

#include <malloc.h>

#include "nn/models/class_names.h"

namespace penumbra::apps {

LoadedNetwork network_of(const nn::StateDict& weights, const std::filesystem::path& source,
                         const std::filesystem::path& classes, const nn::NetworkConfig& config) {
  LoadedNetwork loaded;
  loaded.source = source.string();
  loaded.network = nn::make_network(weights, config);
  malloc_trim(0);  // what tensors took on their way goes back to the system
  loaded.names =
      nn::class_names(weights, loaded.network->classes(), classes, loaded.network->has_background());
  return loaded;
}

}  // namespace penumbra::apps
