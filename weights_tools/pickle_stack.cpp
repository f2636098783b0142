#include "weights_tools/pickle_stack.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "weights_tools/pickle_machine.h"

namespace penumbra::weights_tools {

namespace {

constexpr ValueId kNothing = std::numeric_limits<ValueId>::max();

}  // namespace

std::size_t PickleStack::below_top(std::size_t count) const {
  if (values_.size() - floor() < count) {
    heap_.fail(fmt::format("{} values on the stack", count), fmt::format("{}", values_.size() - floor()));
  }
  return values_.size() - count;
}

ValueId PickleStack::pop() {
  const ValueId value = top();
  values_.pop_back();
  return value;
}

std::size_t PickleStack::pop_mark() {
  if (marks_.empty()) heap_.fail("a mark on the stack", "none");
  const std::size_t height = marks_.back();
  marks_.pop_back();
  return height;
}

void PickleStack::push_tuple(std::size_t begin) {
  Value tuple{.kind = ValueKind::tuple};
  tuple.items.assign(values_.begin() + static_cast<std::ptrdiff_t>(begin), values_.end());
  drop_to(begin);
  push(heap_.add(std::move(tuple)));
}

void PickleStack::append_from(std::size_t begin, ValueKind kind) {
  if (begin <= floor()) heap_.fail(fmt::format("{} below the values", to_string(kind)), "nothing");
  const ValueId container = values_[begin - 1];
  const bool is_object = heap_[container].kind == ValueKind::object;
  if (!is_object || kind == ValueKind::dict) {
    if (!is_object) heap_.expect(container, kind, "the container");
    if (kind == ValueKind::dict && (values_.size() - begin) % 2 != 0) {
      heap_.fail("keys and values in pairs", "a key without a value");
    }
    for (std::size_t i = begin; i < values_.size(); ++i) heap_.append(container, values_[i]);
  }
  drop_to(begin);
}

void PickleMemo::put(std::size_t index, ValueId value) {
  if (index >= kMostPickledValues) {
    heap_.fail(fmt::format("a memo index below {}", kMostPickledValues), fmt::format("{}", index));
  }
  if (index >= values_.size()) values_.resize(index + 1, kNothing);
  values_[index] = value;
}

ValueId PickleMemo::get(std::size_t index) const {
  if (index >= values_.size() || values_[index] == kNothing) {
    heap_.fail("a value that was stored before", fmt::format("memo {}", index));
  }
  return values_[index];
}

}  // namespace penumbra::weights_tools
