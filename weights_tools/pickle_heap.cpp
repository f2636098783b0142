#include "weights_tools/pickle_heap.h"

#include <fmt/format.h>

#include "nn/base/error.h"
#include "weights_tools/pickle_machine.h"

namespace penumbra::weights_tools {

namespace {

// Every item costs the pickle at least a byte, except where a call copies a shared list.
constexpr std::size_t kMostPickledItems = 32'000'000;
}  // namespace

const char* to_string(ValueKind kind) {
  switch (kind) {
    case ValueKind::none:
      return "None";
    case ValueKind::boolean:
      return "a bool";
    case ValueKind::integer:
      return "an int";
    case ValueKind::real:
      return "a float";
    case ValueKind::text:
      return "a str";
    case ValueKind::bytes:
      return "bytes or a very large int";
    case ValueKind::tuple:
      return "a tuple";
    case ValueKind::list:
      return "a list";
    case ValueKind::dict:
      return "a dict";
    case ValueKind::global:
      return "a class or function";
    case ValueKind::storage:
      return "a torch storage";
    case ValueKind::tensor:
      return "a torch tensor";
    case ValueKind::set:
      return "a set";
    case ValueKind::unread_tensor:
      return "a tensor of a kind that is not read";
    case ValueKind::object:
      return "an object";
    case ValueKind::attribute:
      return "a part of a class";
  }
  return "?";
}

const Value* PickledObject::find(const Value& holder, std::string_view key) const {
  if (holder.kind != ValueKind::dict && holder.kind != ValueKind::object) return nullptr;
  const Value* found = nullptr;
  for (std::size_t i = 0; i + 1 < holder.items.size(); i += 2) {
    const Value& name = values[holder.items[i]];
    if (name.kind == ValueKind::text && name.text == key) found = &values[holder.items[i + 1]];
  }
  return found;
}

void PickleHeap::fail(std::string_view expected, std::string_view found) const {
  throw InputError(fmt::format("{}: byte {}", place_, position_), expected, found);
}

ValueId PickleHeap::add(Value value) {
  if (object_.values.size() >= kMostPickledValues) {
    fail(fmt::format("a pickle of at most {} values", kMostPickledValues), "more");
  }
  items_ += value.items.size();
  object_.values.push_back(std::move(value));
  return static_cast<ValueId>(object_.values.size() - 1);
}

void PickleHeap::append(ValueId container, ValueId item) {
  if (++items_ > kMostPickledItems) {
    fail(fmt::format("containers of at most {} items in all", kMostPickledItems), "more");
  }
  object_.values[container].items.push_back(item);
}

const Value& PickleHeap::expect(ValueId id, ValueKind kind, std::string_view what) {
  const Value& value = object_.values[id];
  if (value.kind != kind) {
    fail(fmt::format("{} as {}", what, to_string(kind)), to_string(value.kind));
  }
  return value;
}

void PickleHeap::set_attributes(ValueId target, ValueId state) {
  switch (object_.values[target].kind) {
    case ValueKind::object:
      if (object_.values[state].kind == ValueKind::dict) {
        take_attributes(target, state);
      } else if (object_.values[state].kind == ValueKind::tuple && object_.values[state].items.size() == 2) {
        const ValueId first = object_.values[state].items[0], second = object_.values[state].items[1];
        take_attributes(target, first);
        take_attributes(target, second);
      }
      return;
    case ValueKind::dict:
    case ValueKind::list:
    case ValueKind::set:
    case ValueKind::tuple:
    case ValueKind::tensor:
    case ValueKind::unread_tensor:
      return;
    default:
      fail("attributes for an object",
           fmt::format("attributes for {}", to_string(object_.values[target].kind)));
  }
}

void PickleHeap::take_attributes(ValueId object, ValueId state) {
  if (object_.values[state].kind != ValueKind::dict) return;
  for (std::size_t i = 0; i < object_.values[state].items.size(); ++i) {
    append(object, object_.values[state].items[i]);
  }
}

}  // namespace penumbra::weights_tools
