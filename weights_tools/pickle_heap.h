// The values that a pickle has built so far (used by the pickle machine and its calls alone).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>

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
  // Gives an object the attributes in `state`: a dict of them, or a pair of dicts where its class has slots.
  // Of other values the attributes are dropped: state dicts so carry their modules' versions, which nothing
  // needs.
  void set_attributes(ValueId target, ValueId state);
  // Index into object().storages.
  std::map<std::string_view, std::size_t>& storage_by_key() { return storage_by_key_; }

 private:
  void take_attributes(ValueId object, ValueId state);

  std::string place_;
  PickledObject object_;
  std::size_t position_ = 0;
  std::map<std::string_view, std::size_t> storage_by_key_;
  std::size_t items_ = 0;  // in all containers together
};

}  // namespace penumbra::weights_tools
