#include "tests/support/layer_cases.h"

#include <fstream>
#include <stdexcept>

#include "nn/io/safetensors.h"
#include "tests/support/tensors.h"
#include "tests/support/test_data.h"

namespace penumbra::test {

nn::Activation LayerCase::activation() const {
  const std::string name = option<std::string>("activation", "none");
  if (name == "none") return nn::Activation::none;
  if (name == "relu") return nn::Activation::relu;
  if (name == "leaky_relu") return nn::Activation::leaky_relu;
  if (name == "sigmoid") return nn::Activation::sigmoid;
  if (name == "silu") return nn::Activation::silu;
  if (name == "hard_sigmoid") return nn::Activation::hard_sigmoid;
  if (name == "hard_swish") return nn::Activation::hard_swish;
  throw std::invalid_argument("no activation " + name);
}

bool LayerCase::has(const std::string& name) const {
  for (const auto& input : options.at("inputs")) {
    if (input.at(0) == name) return true;
  }
  return false;
}

nn::Tensor LayerCase::input(const std::string& name) const {
  std::uint32_t stream = 100 * static_cast<std::uint32_t>(index);
  for (const auto& input : options.at("inputs")) {
    if (input.at(0) == name) return random_tensor(input.at(1).get<nn::Shape>(), stream);
    ++stream;
  }
  throw std::invalid_argument(layer() + " has no input " + name);
}

std::vector<float> LayerCase::values(const std::string& name) const {
  return has(name) ? input(name).values : std::vector<float>{};
}

std::vector<nn::Box> LayerCase::boxes(const std::string& name) const {
  const std::vector<float> u = values(name);
  std::vector<nn::Box> boxes;
  for (std::size_t i = 0; i + 3 < u.size(); i += 4) {
    const float x = 30.0F + 40.0F * u[i], y = 30.0F + 40.0F * u[i + 1];
    boxes.push_back({x, y, x + 20.0F * (1.0F + u[i + 2]), y + 20.0F * (1.0F + u[i + 3])});
  }
  return boxes;
}

std::vector<LayerCase> layer_cases() {
  const nn::StateDict outputs = nn::read_safetensors(fixture("layers/outputs.safetensors"));
  const nlohmann::json all = nlohmann::json::parse(std::ifstream(fixture("layers/cases.json")));
  std::vector<LayerCase> cases;
  for (const auto& options : all) {
    const int index = static_cast<int>(cases.size());
    const nn::StoredTensor& stored = outputs.tensors.at(std::to_string(index));
    cases.push_back({index, options, {stored.shape, stored.to_f32()}});
  }
  return cases;
}

}  // namespace penumbra::test
