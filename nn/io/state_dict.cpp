#include "nn/io/state_dict.h"

#include <cstring>

#include "nn/io/half.h"

namespace penumbra::nn {

namespace {

template <class Stored, class Convert>
std::vector<float> convert_all(const StoredTensor& tensor, Convert convert) {
  std::vector<float> values(static_cast<std::size_t>(tensor.elements()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Stored stored;  // the bytes need not be aligned
    std::memcpy(&stored, tensor.bytes.data() + i * sizeof(Stored), sizeof(Stored));
    values[i] = convert(stored);
  }
  return values;
}

template <class Stored>
std::vector<float> cast_all(const StoredTensor& tensor) {
  return convert_all<Stored>(tensor, [](Stored value) { return static_cast<float>(value); });
}

}  // namespace

std::size_t size_of(DataType type) {
  switch (type) {
    case DataType::f64:
    case DataType::i64:
      return 8;
    case DataType::f32:
    case DataType::i32:
      return 4;
    case DataType::f16:
    case DataType::bf16:
    case DataType::i16:
      return 2;
    case DataType::i8:
    case DataType::u8:
    case DataType::boolean:
      return 1;
  }
  return 0;
}

const char* to_string(DataType type) {
  switch (type) {
    case DataType::f64:
      return "F64";
    case DataType::f32:
      return "F32";
    case DataType::f16:
      return "F16";
    case DataType::bf16:
      return "BF16";
    case DataType::i64:
      return "I64";
    case DataType::i32:
      return "I32";
    case DataType::i16:
      return "I16";
    case DataType::i8:
      return "I8";
    case DataType::u8:
      return "U8";
    case DataType::boolean:
      return "BOOL";
  }
  return "?";
}

std::int64_t StoredTensor::elements() const {
  std::int64_t count = 1;
  for (const std::int64_t extent : shape) count *= extent;
  return count;
}

std::vector<float> StoredTensor::to_f32() const {
  switch (type) {
    case DataType::f64:
      return cast_all<double>(*this);
    case DataType::f32:
      return cast_all<float>(*this);
    case DataType::f16:
      return convert_all<std::uint16_t>(*this, f16_to_f32);
    case DataType::bf16:
      return convert_all<std::uint16_t>(*this, bf16_to_f32);
    case DataType::i64:
      return cast_all<std::int64_t>(*this);
    case DataType::i32:
      return cast_all<std::int32_t>(*this);
    case DataType::i16:
      return cast_all<std::int16_t>(*this);
    case DataType::i8:
      return cast_all<std::int8_t>(*this);
    case DataType::u8:
    case DataType::boolean:
      return cast_all<std::uint8_t>(*this);
  }
  return {};
}

}  // namespace penumbra::nn
