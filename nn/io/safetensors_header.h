// The JSON header of a safetensors file (nn/io/safetensors.h), parsed and checked as far as it goes alone.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::nn {

struct SafetensorsEntry {
  std::string name;
  DataType type = DataType::f32;
  std::vector<std::int64_t> shape;
  std::uint64_t begin = 0, end = 0;  // bytes, from the end of the header
};

struct SafetensorsHeader {
  std::vector<SafetensorsEntry> tensors;  // in the order of the header
  std::map<std::string, std::string> metadata;
};

// Checked here: well-formed JSON of exactly this structure (nesting deeper than it is refused at once, so the
// parser's memory is bounded), no name twice, known element types, extents and offsets that are whole numbers
// >= 0, end - begin = element size * product of the shape, computed without overflow.
// Throws InputError; `place` is the file's name.
SafetensorsHeader parse_safetensors_header(std::string_view json, const std::string& place);

}  // namespace penumbra::nn
