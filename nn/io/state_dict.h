// A network's named tensors as a checkpoint file stores them.
//
// The tensors are views: their bytes stay in the file's memory map (safetensors) or in a buffer that the
// StateDict keeps alive, so loading copies nothing and copies of a StateDict are cheap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/mapped_file.h"

namespace penumbra::nn {

// The first row has values that networks can be made of; tensors of the others are only carried along.
enum class DataType {
  f64,
  f32,
  f16,
  bf16,
  i64,
  i32,
  i16,
  i8,
  u8,
  boolean,  //
  u64,
  u32,
  u16,
  c128,
  c64,
  f8_e5m2,
  f8_e4m3,
  f8_e8m0,
  f6_e3m2,
  f6_e2m3,
  f4
};

std::size_t size_of(DataType type);    // bytes of one element, rounded up
const char* to_string(DataType type);  // safetensors' names: "F32", "BF16", "I64", ...
std::optional<DataType> data_type_named(std::string_view name);
// Bytes of so many elements side by side; none where they do not fill whole bytes or pass 2^63.
std::optional<std::uint64_t> bytes_of(DataType type, std::uint64_t elements);
bool has_f32_values(DataType type);  // of the first row

// One tensor: contiguous, row-major, little-endian.
struct StoredTensor {
  DataType type = DataType::f32;
  std::vector<std::int64_t> shape;   // empty for a scalar
  std::span<const std::byte> bytes;  // bytes_of(type, product of shape)

  std::int64_t elements() const;
  // All elements as f32, in order (f16, bf16, f64 and integers are converted; integers above 2^24 are
  // rounded). Throws InputError unless has_f32_values(type).
  std::vector<float> to_f32() const;
};

struct StateDict {
  std::string source;                           // the file's name, for error messages
  std::map<std::string, StoredTensor> tensors;  // by name, such as "backbone.body.layer1.0.conv1.weight"
  std::map<std::string, std::string> metadata;  // safetensors' __metadata__, or what a pickled network says
  std::vector<std::string> notes;               // what the reader chose or left out, for the user
  std::vector<std::shared_ptr<const void>> owners;  // keep the bytes alive
  std::shared_ptr<const MappedFile> file;           // in which some of them lie; null for none

  // The tensor has been read: its part of the file need not stay in memory.
  void forget(const StoredTensor& tensor) const {
    if (file) file->forget(tensor.bytes);
  }
};

}  // namespace penumbra::nn
