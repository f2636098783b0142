#include "tests/support/product_quantised.h"

#include "tests/support/random_models.h"
#include "tests/support/random_network.h"

namespace penumbra::test {

nn::StateDict decode_product_quantised(const nn::StateDict& quantised) {
  // Names and shapes; random_resnet has 10 classes, the file 1000.
  nn::StateDict state = random_resnet(50, 64);
  state.source = quantised.source;
  state.tensors["fc.weight"].shape = {1000, 2048};
  state.tensors["fc.bias"].shape = {1000};
  for (auto& [name, tensor] : state.tensors) {
    auto values = std::make_shared<std::vector<float>>();
    const std::string layer = name.substr(0, name.rfind('.'));
    const auto plain = quantised.tensors.find(name);
    if (plain != quantised.tensors.end()) {
      *values = plain->second.to_f32();
    } else if (quantised.tensors.contains(layer + ".codes_matrix")) {
      const std::vector<float> codes = quantised.tensors.at(layer + ".codes_matrix").to_f32();
      const nn::StoredTensor& book = quantised.tensors.at(layer + ".codebook");
      const std::vector<float> entries = book.to_f32();
      const auto length = static_cast<std::size_t>(book.shape.at(1));
      for (const float code : codes) {
        const auto first =
            entries.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(code) * length);
        values->insert(values->end(), first, first + static_cast<std::ptrdiff_t>(length));
      }
    } else {
      values->assign(static_cast<std::size_t>(nn::elements(tensor.shape)),
                     name.ends_with("running_var") ? 1.0F : 0.0F);
    }
    tensor.bytes = std::as_bytes(std::span(*values));
    state.owners.push_back(std::move(values));
  }
  return state;
}

}  // namespace penumbra::test
