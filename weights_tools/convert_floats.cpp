#include "weights_tools/convert_floats.h"

#include <cmath>
#include <cstring>

#include "nn/base/error.h"
#include "nn/io/half.h"
#include "weights_tools/torch_storages.h"

namespace penumbra::weights_tools {

namespace {

using nn::DataType;

bool is_float(DataType type) {
  return type == DataType::f64 || type == DataType::f32 || type == DataType::f16 || type == DataType::bf16;
}

constexpr std::uint16_t kInfinityF16 = 0x7C00;

// Returns false where a finite value became infinite.
bool store_as_f16(const std::vector<float>& values, std::byte* out) {
  bool in_range = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint16_t half = nn::f32_to_f16(values[i]);
    in_range &= (half & 0x7FFFU) != kInfinityF16 || std::isinf(values[i]);
    std::memcpy(out + 2 * i, &half, 2);
  }
  return in_range;
}

}  // namespace

FloatConversion convert_floats(const nn::StateDict& state, nn::DataType type) {
  if (type != DataType::f32 && type != DataType::f16) throw UsageError("convert to f32 or f16");
  FloatConversion result{.state = state, .converted = 0, .out_of_range = {}};
  for (auto& [name, tensor] : result.state.tensors) {
    if (!is_float(tensor.type) || tensor.type == type) continue;
    const std::vector<float> values = tensor.to_f32();
    const std::size_t bytes = values.size() * size_of(type);
    const std::shared_ptr<std::byte[]> buffer = make_buffer(bytes);
    if (type == DataType::f16) {
      if (!store_as_f16(values, buffer.get())) result.out_of_range.push_back(name);
    } else if (bytes > 0) {
      std::memcpy(buffer.get(), values.data(), bytes);
    }
    tensor.type = type;
    tensor.bytes = {buffer.get(), bytes};
    result.state.owners.push_back(buffer);
    ++result.converted;
  }
  return result;
}

}  // namespace penumbra::weights_tools
