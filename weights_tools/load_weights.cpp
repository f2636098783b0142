#include "weights_tools/load_weights.h"

#include "nn/base/error.h"

namespace penumbra::weights_tools {

nn::StateDict load_weights(const std::filesystem::path& path) {
  throw InputError(path.string(), "a safetensors or PyTorch file", "something else");
}

}  // namespace penumbra::weights_tools
