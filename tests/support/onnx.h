// Reads as much of ONNX's files as its operator tests need: the nodes of a graph with their attributes, and
// tensors.
//
// A file is one protobuf message: fields, each a key (number * 8 + wire type, a varint) and a value, which is
// a varint (wire type 0), 8 bytes (1), 4 bytes (5), or a length and as many bytes (2: strings, messages,
// packed numbers). Source: onnx.proto of ONNX 1.12; https://protobuf.dev/programming-guides/encoding
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nn/tensor/tensor.h"

namespace penumbra::test {

struct OnnxAttribute {
  float number = 0.0F;
  std::int64_t integer = 0;
  std::string text;
  std::vector<float> numbers;
  std::vector<std::int64_t> integers;
};

struct OnnxTensor {
  enum Type { f32 = 1, u8 = 2, i32 = 6, i64 = 7, boolean = 9, f64 = 11 };
  int type = f32;
  std::string name;
  nn::Tensor tensor;  // every type as f32
};

struct OnnxNode {
  std::string operation;
  std::vector<std::string> inputs, outputs;  // "" for an optional one that is left out
  std::map<std::string, OnnxAttribute> attributes;

  std::int64_t integer(const std::string& name, std::int64_t otherwise) const;
  float number(const std::string& name, float otherwise) const;
  std::string text(const std::string& name, const std::string& otherwise) const;
  std::vector<std::int64_t> integers(const std::string& name, std::vector<std::int64_t> otherwise) const;
};

struct OnnxModel {
  int opset = 0;  // of the standard operators
  std::vector<OnnxNode> nodes;
  std::vector<OnnxTensor> initializers;
  std::vector<std::string> inputs, outputs;
};

// Throw InputError where the bytes are no such message; `place` is for its message.
OnnxModel parse_onnx_model(std::string_view bytes, const std::string& place);
OnnxTensor parse_onnx_tensor(std::string_view bytes, const std::string& place);

}  // namespace penumbra::test
