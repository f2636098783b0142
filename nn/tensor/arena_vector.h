// A vector in an arena, whose capacity is set once: for lists whose length depends on the picture (boxes,
// scores) and whose capacity does not, so that a pass asks for the same memory whatever the picture shows.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <type_traits>

#include "nn/tensor/arena.h"

namespace penumbra::nn {

template <class T>
class ArenaVector {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  ArenaVector() = default;
  // Empty.
  ArenaVector(Arena& arena, std::size_t capacity)
      : memory_(arena.allocate((capacity * sizeof(T) + sizeof(float) - 1) / sizeof(float))),
        capacity_(capacity) {}
  ArenaVector(ArenaVector&&) = default;
  ArenaVector& operator=(ArenaVector&&) = default;

  // Both throw std::length_error beyond the capacity. New elements of resize are uninitialised.
  void push_back(const T& value) {
    resize(size_ + 1);
    data()[size_ - 1] = value;
  }
  void resize(std::size_t size) {
    if (size > capacity_) throw std::length_error("ArenaVector: larger than its capacity");
    size_ = size;
  }
  void clear() { size_ = 0; }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T* data() { return reinterpret_cast<T*>(memory_.data()); }
  const T* data() const { return reinterpret_cast<const T*>(memory_.data()); }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  std::span<T> span() { return {data(), size_}; }
  std::span<const T> span() const { return {data(), size_}; }

 private:
  ArenaBuffer memory_;
  std::size_t capacity_ = 0, size_ = 0;
};

}  // namespace penumbra::nn
