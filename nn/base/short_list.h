// A list of at most N values without memory of its own on the heap, for results that are never many.
#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>

namespace penumbra {

template <typename T, std::size_t N>
class ShortList {
 public:
  // Throws std::length_error where the list is full.
  void push_back(const T& value) {
    if (size_ == N) throw std::length_error("ShortList is full");
    values_[size_++] = value;
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return values_[i]; }
  T* begin() { return values_.data(); }
  T* end() { return values_.data() + size_; }
  const T* begin() const { return values_.data(); }
  const T* end() const { return values_.data() + size_; }

 private:
  std::array<T, N> values_{};
  std::size_t size_ = 0;
};

}  // namespace penumbra
