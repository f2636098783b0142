// A value for each of some keyframes of a map, found by the keyframe's id: what votes and windows are counted
// in. Emptied at no cost, and made for many uses one after the other: it keeps its memory, 16 bytes for each
// id that there was.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "slam/map/keyframe.h"

namespace penumbra::slam {

class KeyframeTable {
 public:
  struct Entry {
    KeyFrame* keyframe;
    int value;
  };

  void clear() {
    entries_.clear();
    ++round_;
  }
  // The keyframe's value, 0 where it had none.
  int& operator[](KeyFrame* keyframe) {
    const auto id = static_cast<std::size_t>(keyframe->id);
    if (places_.size() <= id) places_.resize(std::max(id + 1, 2 * places_.size()));
    Place& place = places_[id];
    if (place.round != round_) {
      place = {round_, static_cast<std::uint32_t>(entries_.size())};
      entries_.push_back({keyframe, 0});
    }
    return entries_[place.entry].value;
  }
  // nullptr where it has none.
  const int* find(const KeyFrame* keyframe) const {
    const auto id = static_cast<std::size_t>(keyframe->id);
    if (places_.size() <= id || places_[id].round != round_) return nullptr;
    return &entries_[places_[id].entry].value;
  }
  // In the order in which they came, until it is sorted.
  std::vector<Entry>& entries() { return entries_; }
  // The greatest value first, the oldest of equals first. Values are not to be found by their keyframes then.
  void sort_by_value() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return a.value != b.value ? a.value > b.value : a.keyframe->id < b.keyframe->id;
    });
    ++round_;
  }

 private:
  struct Place {
    std::uint64_t round = 0;
    std::uint32_t entry = 0;
  };
  std::vector<Place> places_;  // by id
  std::vector<Entry> entries_;
  std::uint64_t round_ = 1;
};

}  // namespace penumbra::slam
