#include "nn/tensor/arena.h"

#include <cstdlib>
#include <new>
#include <utility>

namespace penumbra::nn {

namespace {

constexpr std::size_t kAlignment = 64;  // a cache line, and the widest vector

}  // namespace

ArenaBuffer& ArenaBuffer::operator=(ArenaBuffer&& other) noexcept {
  if (this != &other) {
    release();
    arena_ = std::exchange(other.arena_, nullptr);
    slot_ = other.slot_;
    data_ = std::exchange(other.data_, nullptr);
  }
  return *this;
}

void ArenaBuffer::release() {
  if (arena_ != nullptr) arena_->slots_[slot_].in_use = false;
  arena_ = nullptr;
}

void Arena::Free::operator()(float* data) const { std::free(data); }

ArenaBuffer Arena::allocate(std::size_t count) {
  std::size_t best = slots_.size();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const Slot& slot = slots_[i];
    if (slot.in_use || slot.capacity < count) continue;
    if (best == slots_.size() || slot.capacity < slots_[best].capacity) best = i;
  }
  if (best == slots_.size()) {
    const std::size_t bytes = (count * sizeof(float) + kAlignment) / kAlignment * kAlignment;
    auto* data = static_cast<float*>(std::aligned_alloc(kAlignment, bytes));
    if (data == nullptr) throw std::bad_alloc();
    slots_.push_back({std::unique_ptr<float, Free>(data), bytes / sizeof(float), false});
  }
  slots_[best].in_use = true;
  return {this, best, slots_[best].data.get()};
}

std::size_t Arena::bytes() const {
  std::size_t total = 0;
  for (const Slot& slot : slots_) total += slot.capacity * sizeof(float);
  return total;
}

}  // namespace penumbra::nn
