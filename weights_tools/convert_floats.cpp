#include "weights_tools/convert_floats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "nn/base/error.h"
#include "nn/base/half.h"
#include "nn/base/text.h"
#include "weights_tools/torch_storages.h"

namespace penumbra::weights_tools {

namespace {

using nn::DataType;

bool is_float(DataType type) {
  return type == DataType::f64 || type == DataType::f32 || type == DataType::f16 || type == DataType::bf16;
}

constexpr float kLeastOverflowF16 = 65520.0F;  // rounds to infinity
constexpr float kLeastNormalF16 = 0x1p-14F;

bool has_batch_norm(const nn::StateDict& state, const std::string& name) {
  const std::string module = name.substr(0, name.rfind('.') + 1);
  return state.tensors.contains(module + "running_var");
}

// Whether f16 keeps the values' range. Vectors have no rows: their small values are added to larger ones.
bool fits_f16(const std::vector<float>& values, const std::vector<std::int64_t>& shape) {
  const bool has_rows = shape.size() > 1;
  const std::size_t rows = has_rows ? static_cast<std::size_t>(shape.front()) : 1;
  const std::size_t columns = rows == 0 ? 0 : values.size() / rows;
  for (std::size_t row = 0; row < rows; ++row) {
    float largest = 0.0F;
    for (std::size_t i = row * columns; i < (row + 1) * columns; ++i) {
      const float magnitude = std::abs(values[i]);
      if (magnitude >= kLeastOverflowF16 && !std::isinf(magnitude)) return false;
      largest = std::max(largest, magnitude);
    }
    if (has_rows && largest > 0.0F && largest < kLeastNormalF16) return false;
  }
  return true;
}

void store_as_f16(const std::vector<float>& values, std::byte* out) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint16_t half = nn::f32_to_f16(values[i]);
    std::memcpy(out + 2 * i, &half, 2);
  }
}

// Throws where a finite f64 is infinite as f32, through which all values go.
void check_f32_holds(const nn::StateDict& state, const std::string& name, const nn::StoredTensor& tensor,
                     const std::vector<float>& values) {
  if (tensor.type != DataType::f64) return;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isinf(values[i])) continue;
    double exact = 0.0;
    std::memcpy(&exact, tensor.bytes.data() + i * sizeof exact, sizeof exact);
    if (std::isfinite(exact)) {
      throw InputError(fmt::format("{}: tensor \"{}\"", state.source, printable(name)),
                       "values within the range of f32", fmt::format("{} at index {}", exact, i));
    }
  }
}

}  // namespace

FloatConversion convert_floats(const nn::StateDict& state, nn::DataType type) {
  if (type != DataType::f32 && type != DataType::f16) throw UsageError("convert to f32 or f16");
  FloatConversion result{.state = state, .converted = 0, .batch_norms = 0, .out_of_range = {}};
  for (auto& [name, tensor] : result.state.tensors) {
    if (!is_float(tensor.type) || tensor.type == type) continue;
    const std::vector<float> values = tensor.to_f32();
    check_f32_holds(state, name, tensor, values);
    DataType stored = type;
    if (type == DataType::f16 && has_batch_norm(state, name)) {
      stored = DataType::f32;
      ++result.batch_norms;
    } else if (type == DataType::f16 && !fits_f16(values, tensor.shape)) {
      stored = DataType::f32;
      result.out_of_range.push_back(name);
    }
    if (stored == tensor.type) continue;
    const std::size_t bytes = values.size() * size_of(stored);
    const std::shared_ptr<std::byte[]> buffer = make_buffer(bytes);
    if (stored == DataType::f16) {
      store_as_f16(values, buffer.get());
    } else if (bytes > 0) {
      std::memcpy(buffer.get(), values.data(), bytes);
    }
    tensor.type = stored;
    tensor.bytes = {buffer.get(), bytes};
    result.state.owners.push_back(buffer);
    ++result.converted;
  }
  return result;
}

std::vector<std::string> leave_out_unwritable(nn::StateDict& state) {
  std::vector<std::string> names;
  for (const auto& [name, tensor] : state.tensors) {
    if (tensor.type == DataType::c128) names.push_back(name);
  }
  for (const std::string& name : names) state.tensors.erase(name);
  return names;
}

}  // namespace penumbra::weights_tools
