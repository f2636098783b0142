// A network's named tensors as a checkpoint file stores them.
//
// The tensors are views: their bytes stay in the file's memory map (safetensors) or in a buffer that the
// StateDict keeps alive, so loading copies nothing and copies of a StateDict are cheap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace penumbra::nn {

enum class DataType { f64, f32, f16, bf16, i64, i32, i16, i8, u8, boolean };

std::size_t size_of(DataType type);    // bytes of one element
const char* to_string(DataType type);  // safetensors' names: "F32", "BF16", "I64", ...

// One tensor: contiguous, row-major, little-endian.
struct StoredTensor {
  DataType type = DataType::f32;
  std::vector<std::int64_t> shape;   // empty for a scalar
  std::span<const std::byte> bytes;  // size_of(type) * product of shape

  std::int64_t elements() const;
  // All elements as f32, in order (f16, bf16, f64 and integers are converted; integers above 2^24 are
  // rounded).
  std::vector<float> to_f32() const;
};

struct StateDict {
  std::string source;                               // the file's name, for error messages
  std::map<std::string, StoredTensor> tensors;      // by name, such as "backbone.body.layer1.0.conv1.weight"
  std::map<std::string, std::string> metadata;      // safetensors' __metadata__; empty for .pth
  std::vector<std::shared_ptr<const void>> owners;  // keep the bytes alive
};

}  // namespace penumbra::nn
