#include "nn/io/state_dict.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "nn/base/error.h"
#include "nn/base/half.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

template <class Stored, class Convert>
std::vector<float> convert_all(const StoredTensor& tensor, Convert convert) {
  std::vector<float> values(static_cast<std::size_t>(tensor.elements()));
  const auto count = static_cast<std::int64_t>(values.size());
  parallel_pieces(count, grain_of(1), [&](std::int64_t first, std::int64_t end, int) {
    const std::byte* from = tensor.bytes.data() + static_cast<std::size_t>(first) * sizeof(Stored);
    for (std::int64_t i = first; i < end; ++i, from += sizeof(Stored)) {
      Stored stored;  // the bytes need not be aligned
      std::memcpy(&stored, from, sizeof(Stored));
      values[static_cast<std::size_t>(i)] = convert(stored);
    }
  });
  return values;
}

template <class Stored>
std::vector<float> cast_all(const StoredTensor& tensor) {
  return convert_all<Stored>(tensor, [](Stored value) { return static_cast<float>(value); });
}

struct TypeFacts {
  DataType type;
  const char* name;
  std::uint64_t bits;
};

constexpr std::array kTypes = {
    TypeFacts{DataType::f64, "F64", 64},        TypeFacts{DataType::f32, "F32", 32},
    TypeFacts{DataType::f16, "F16", 16},        TypeFacts{DataType::bf16, "BF16", 16},
    TypeFacts{DataType::i64, "I64", 64},        TypeFacts{DataType::i32, "I32", 32},
    TypeFacts{DataType::i16, "I16", 16},        TypeFacts{DataType::i8, "I8", 8},
    TypeFacts{DataType::u8, "U8", 8},           TypeFacts{DataType::boolean, "BOOL", 8},
    TypeFacts{DataType::u64, "U64", 64},        TypeFacts{DataType::u32, "U32", 32},
    TypeFacts{DataType::u16, "U16", 16},        TypeFacts{DataType::c128, "C128", 128},
    TypeFacts{DataType::c64, "C64", 64},        TypeFacts{DataType::f8_e5m2, "F8_E5M2", 8},
    TypeFacts{DataType::f8_e4m3, "F8_E4M3", 8}, TypeFacts{DataType::f8_e8m0, "F8_E8M0", 8},
    TypeFacts{DataType::f6_e3m2, "F6_E3M2", 6}, TypeFacts{DataType::f6_e2m3, "F6_E2M3", 6},
    TypeFacts{DataType::f4, "F4", 4},
};

const TypeFacts& facts_of(DataType type) {
  return *std::find_if(kTypes.begin(), kTypes.end(),
                       [&](const TypeFacts& facts) { return facts.type == type; });
}

}  // namespace

std::size_t size_of(DataType type) { return (facts_of(type).bits + 7) / 8; }

const char* to_string(DataType type) { return facts_of(type).name; }

std::optional<DataType> data_type_named(std::string_view name) {
  for (const TypeFacts& facts : kTypes) {
    if (name == facts.name) return facts.type;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> bytes_of(DataType type, std::uint64_t elements) {
  std::uint64_t bits = 0;
  if (__builtin_mul_overflow(elements, facts_of(type).bits, &bits)) {
    // Whole bytes: the product may pass 2^64 bits and be less than 2^63 bytes.
    std::uint64_t bytes = 0;
    const bool fits =
        facts_of(type).bits % 8 == 0 && !__builtin_mul_overflow(elements, size_of(type), &bytes);
    if (!fits || bytes > std::uint64_t{std::numeric_limits<std::int64_t>::max()}) return std::nullopt;
    return bytes;
  }
  return bits % 8 == 0 ? std::optional(bits / 8) : std::nullopt;
}

bool has_f32_values(DataType type) { return type <= DataType::boolean; }

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
      return convert_all<std::uint16_t>(*this, [](std::uint16_t bits) { return f16_to_f32(bits); });
    case DataType::bf16:
      return convert_all<std::uint16_t>(*this, [](std::uint16_t bits) { return bf16_to_f32(bits); });
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
    default:
      break;
  }
  throw InputError("tensor", "an element type of numbers", to_string(type));
}

}  // namespace penumbra::nn
