// The stack of the pickle machine, with its marks, and its memo (used by the pickle machine alone). Values
// live on the heap: both hold their numbers. A mark hides what lies below it until it is popped.
//
// Each operation throws InputError, at the heap's position, where the pickle asks for what is not there.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "weights_tools/pickle_heap.h"

namespace penumbra::weights_tools {

class PickleStack {
 public:
  explicit PickleStack(PickleHeap& heap) : heap_(heap) {}

  void push(ValueId value) { values_.push_back(value); }
  ValueId top() const { return values_[below_top(1)]; }
  ValueId pop();
  // The text on top; `what` names it in messages.
  std::string_view pop_text(std::string_view what) { return heap_.expect(pop(), ValueKind::text, what).text; }
  // The stack's height without its `count` top values.
  std::size_t below_top(std::size_t count) const;
  void drop_to(std::size_t height) { values_.resize(height); }

  void mark() { marks_.push_back(values_.size()); }
  // The height at which the newest mark was set.
  std::size_t pop_mark();

  // Makes one tuple of the values from `begin` upwards.
  void push_tuple(std::size_t begin);
  // Moves the values from `begin` upwards into the container below them. An object of a class that is a dict
  // keeps keys and values as it keeps attributes; one that is a list or a set keeps nothing.
  void append_from(std::size_t begin, ValueKind kind);

 private:
  std::size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }

  PickleHeap& heap_;
  std::vector<ValueId> values_;
  std::vector<std::size_t> marks_;  // heights
};

// Values by number. Pickles number what they store from 0 upwards, so a table suffices.
class PickleMemo {
 public:
  explicit PickleMemo(PickleHeap& heap) : heap_(heap) {}

  std::size_t size() const { return values_.size(); }
  void put(std::size_t index, ValueId value);
  ValueId get(std::size_t index) const;

 private:
  PickleHeap& heap_;
  std::vector<ValueId> values_;  // kNothing where nothing was stored
};

}  // namespace penumbra::weights_tools
