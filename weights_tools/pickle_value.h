// What a pickle describes, as plain data. Values live in one table and refer to each other by index, so
// shared and cyclic objects cost nothing, destruction does not recurse, and memory is linear in the pickle's
// length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::weights_tools {

// The Python globals that a state dict may name. They are labels: nothing is imported or called.
enum class GlobalKind : std::uint8_t {
  ordered_dict,       // collections.OrderedDict
  size,               // torch.Size: a tuple
  storage,            // torch.FloatStorage and its kin: an element type
  rebuild_tensor,     // torch._utils._rebuild_tensor, _rebuild_tensor_v2
  rebuild_parameter,  // torch._utils._rebuild_parameter, torch.nn.Parameter: their first argument
  rebuild_from_type,  // torch._tensor._rebuild_from_type_v2: calls its first argument on its third
  inert,              // harmless and of no interest: argparse.Namespace, collections.Counter, dtypes ...
};

struct Global {
  GlobalKind kind = GlobalKind::inert;
  nn::DataType type = nn::DataType::f32;  // of a storage
};

enum class ValueKind : std::uint8_t {
  none,
  boolean,
  integer,
  real,   // its value is not kept
  text,   // str
  bytes,  // bytes, and integers beyond 64 bits as their little-endian bytes
  tuple,
  list,
  dict,  // also OrderedDict
  global,
  storage,  // number: index into PickledObject::slices
  tensor,   // items: storage, offset, size, stride; number: the byte that built it
  opaque,   // an object of an inert class
};

const char* to_string(ValueKind kind);  // "a dict", "None", ...

using ValueId = std::uint32_t;

struct Value {
  ValueKind kind = ValueKind::none;
  Global global{};               // global
  std::int64_t number = 0;       // integer, boolean, storage, tensor
  std::string_view text{};       // text and bytes: a view of the pickle
  std::vector<ValueId> items{};  // tuple, list; dict: key, value, key, value ...; tensor
};

// A storage that the pickle refers to by key; its bytes lie elsewhere in the file.
struct StorageRequest {
  std::string_view key;
  nn::DataType type = nn::DataType::f32;
  std::int64_t elements = 0;
  std::size_t position = 0;  // byte of the pickle, for messages
};

// A part of a storage: all of it, or a "storage view" of the legacy format.
struct StorageSlice {
  std::size_t storage = 0;  // index into PickledObject::storages
  std::int64_t offset = 0, elements = 0;
};

// One pickle, run. Valid as long as the bytes that it was read from.
struct PickledObject {
  std::vector<Value> values;
  ValueId root = 0;
  std::vector<StorageRequest> storages;  // each key once, in order of appearance
  std::vector<StorageSlice> slices;
  std::size_t end = 0;  // the byte after the pickle

  const Value& operator[](ValueId id) const { return values[id]; }
};

}  // namespace penumbra::weights_tools
