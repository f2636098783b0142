// The calls that a pickle asks for, answered by building descriptions (used by the pickle machine alone).
#pragma once

#include <map>
#include <string>

#include "weights_tools/pickle_value.h"

namespace penumbra::weights_tools {

// The growing table of values: counts what it holds and refuses to pass the limits.
class PickleHeap {
 public:
  explicit PickleHeap(std::string place) : place_(std::move(place)) {}

  PickledObject& object() { return object_; }
  Value& operator[](ValueId id) { return object_.values[id]; }

  // The opcode that is being carried out, for messages.
  void set_position(std::size_t position) { position_ = position; }
  std::size_t position() const { return position_; }
  // Throws InputError at the current position.
  [[noreturn]] void fail(std::string_view expected, std::string_view found) const;

  ValueId add(Value value);                      // throws InputError beyond kMostPickledValues
  void append(ValueId container, ValueId item);  // throws InputError beyond kMostPickledItems
  // The value, where it is of that kind; throws InputError where it is not.
  const Value& expect(ValueId id, ValueKind kind, std::string_view what);
  // Index into object().storages.
  std::map<std::string_view, std::size_t>& storage_by_key() { return storage_by_key_; }

 private:
  std::string place_;
  PickledObject object_;
  std::size_t position_ = 0;
  std::map<std::string_view, std::size_t> storage_by_key_;
  std::size_t items_ = 0;  // in all containers together
};

// function(*arguments): a dict, set or tensor where it builds one, else an object without attributes. Throws
// InputError where the result of getattr is called, as only attacks need.
ValueId call(PickleHeap& heap, ValueId function, ValueId arguments);

// The storage that a persistent id ('storage', type, key, location, elements[, view]) names; the view, in the
// legacy format, is None or (key, offset, elements).
ValueId find_storage(PickleHeap& heap, ValueId persistent_id);

}  // namespace penumbra::weights_tools
