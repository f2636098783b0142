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

// What the Python globals that a checkpoint names stand for. They are labels: nothing is imported or called.
enum class GlobalKind : std::uint8_t {
  ordered_dict,       // collections.OrderedDict
  dict,               // dict, collections.defaultdict, Counter: with or without a mapping to begin with
  set,                // set, frozenset
  size,               // torch.Size: a tuple
  storage,            // torch.FloatStorage and its kin: an element type
  rebuild_tensor,     // torch._utils._rebuild_tensor, _rebuild_tensor_v2
  rebuild_parameter,  // torch._utils._rebuild_parameter, torch.nn.Parameter: their first argument
  rebuild_from_type,  // torch._tensor._rebuild_from_type_v2: calls its first argument on its third
  unread_tensor,      // functions that rebuild sparse, quantised and other tensors that are not read
  attribute,          // getattr: the name of something inside a class
  record,             // every other class or function: its objects are attributes by name
};

struct Global {
  GlobalKind kind = GlobalKind::record;
  nn::DataType type = nn::DataType::f32;  // of a storage
};

enum class ValueKind : std::uint8_t {
  none,
  boolean,
  integer,
  real,   // number: the bits of the double
  text,   // str
  bytes,  // bytes, and integers beyond 64 bits as their little-endian bytes
  tuple,
  list,
  dict,  // also OrderedDict and its kin
  set,
  global,         // text: its name without the module
  storage,        // number: index into PickledObject::slices
  tensor,         // items: storage, offset, size, stride[, metadata]; number: the byte that built it
  unread_tensor,  // text: the function that would rebuild it
  object,         // of a class that is a record; text: the class's name; items as in a dict: its attributes
  attribute,      // the result of getattr
};

const char* to_string(ValueKind kind);  // "a dict", "None", ...

using ValueId = std::uint32_t;

struct Value {
  ValueKind kind = ValueKind::none;
  Global global{};               // global
  std::int64_t number = 0;       // integer, boolean, real, storage, tensor
  std::string_view text{};       // text, bytes, global, object: a view of the pickle
  std::vector<ValueId> items{};  // tuple, list, set; dict, object: key, value, key, value ...; tensor
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
  // What stands under a text in a dict, or the attribute of that name in an object; the last one where there
  // are several, null where there is none.
  const Value* find(const Value& holder, std::string_view key) const;
};

}  // namespace penumbra::weights_tools
