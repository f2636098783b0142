// Memory for activations: buffers are given back when their owner dies and handed out again, so after the
// first frame of a shape nothing is allocated. One network at a time uses an arena; it is not thread-safe.
//
// The smallest free buffer that is large enough is taken. A network asks in the same order every frame, so
// every frame gets the same buffers.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace penumbra::nn {

class Arena;

// A 64-byte aligned piece of an arena; returns to it when destroyed. Contents are whatever was there before.
class ArenaBuffer {
 public:
  ArenaBuffer() = default;
  ArenaBuffer(ArenaBuffer&& other) noexcept { *this = std::move(other); }
  ArenaBuffer& operator=(ArenaBuffer&& other) noexcept;
  ~ArenaBuffer() { release(); }

  float* data() const { return data_; }

 private:
  friend class Arena;
  ArenaBuffer(Arena* arena, std::size_t slot, float* data) : arena_(arena), slot_(slot), data_(data) {}
  void release();

  Arena* arena_ = nullptr;
  std::size_t slot_ = 0;
  float* data_ = nullptr;
};

class Arena {
 public:
  Arena() = default;
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // A buffer of at least `count` floats. The arena must outlive it.
  ArenaBuffer allocate(std::size_t count);

  std::size_t bytes() const;                                 // held from the system
  std::size_t allocations() const { return slots_.size(); }  // made from the system so far

 private:
  friend class ArenaBuffer;
  struct Free {
    void operator()(float* data) const;
  };
  struct Slot {
    std::unique_ptr<float, Free> data;
    std::size_t capacity = 0;  // floats
    bool in_use = false;
  };
  std::vector<Slot> slots_;
};

}  // namespace penumbra::nn
