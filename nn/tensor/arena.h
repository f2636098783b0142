// Memory for activations: one block, planned from the schedule of a forward pass.
//
// The order in which a network asks for buffers and gives them back is the same whenever the shape of its
// input is. So the first pass of a shape is recorded, each buffer in a piece of memory of its own or in one
// that another has left (memory that was touched serves again); from its steps memory_plan.h gives each
// buffer an offset in that block; the later passes of the shape replay the plan: the k-th step is checked
// against the k-th one recorded, a buffer is the block plus its offset, and nothing is allocated.
//
//   Arena::Pass pass(arena, this, height, width);   // begins: replay where a plan is known, else record
//   FeatureMap y = conv(x, arena);                  // allocate and release are the steps
//                                                   // pass ends: a recorded schedule is planned
//
// What depends on the picture and not on its shape (the number of regions, say) must ask for the most that
// there may be: Batch in feature_map.h and ArenaVector. A pass that strays from its plan is still correct:
// from that step on its buffers have memory of their own, and the next pass of the shape is recorded anew.
// Outside of passes every buffer has memory of its own.
//
// One arena serves one thread: threads that share a network have one each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "nn/base/page_block.h"
#include "nn/tensor/memory_plan.h"

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
  void release();

  Arena* arena_ = nullptr;
  float* data_ = nullptr;
  std::size_t bytes_ = 0;
  std::size_t index_ = 0;   // among the buffers of its pass
  std::uint64_t pass_ = 0;  // number of its pass; 0 outside of passes
  bool in_block_ = false;   // else it has memory of its own:
  bool in_piece_ = false;   // from a pass that was recorded
};

class Arena {
 public:
  Arena() = default;
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // One forward pass of `network` (any address that tells networks apart) on an input whose extents decide
  // the schedule. Inside another pass it is a part of that one.
  class Pass {
   public:
    Pass(Arena& arena, const void* network, int height, int width);
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;
    ~Pass();

   private:
    Arena* arena_;
  };

  // A buffer of at least `count` floats. The arena must outlive it.
  ArenaBuffer allocate(std::size_t count);

  std::size_t bytes() const { return held_; }             // of the block, and of buffers outside
  std::size_t peak_bytes() const { return peak_; }        // the most that ever was
  std::size_t recordings() const { return recordings_; }  // passes so far that had no plan

 private:
  friend class ArenaBuffer;
  struct Key {
    const void* network;
    int height, width;
    int threads;  // layers have scratch memory for each
    bool operator==(const Key&) const = default;
  };
  // A request of `bytes`, or where that is 0 the release of a buffer.
  struct Step {
    std::size_t buffer, bytes;
    bool operator==(const Step&) const = default;
  };
  struct Schedule {
    Key key{};
    std::vector<Step> steps;
    MemoryPlan plan;
    std::uint64_t last_pass = 0;  // that used it
  };
  enum class Mode { loose, recording, replaying };

  void begin(const Key& key);
  void end();
  // Notes or checks the next step of the pass; whether the schedule still holds.
  void step(const Step& step);
  void release(const ArenaBuffer& buffer);
  void make_plan(Schedule& schedule) const;
  void make_block();  // as large as the largest plan
  void free_block();
  void hold(std::size_t bytes);
  // Memory of their own, for buffers of a pass that is recorded.
  float* take_piece(std::size_t bytes);
  void leave_piece(float* data);

  std::vector<Schedule> schedules_;
  std::size_t current_ = 0;  // of schedules_, in a pass
  Mode mode_ = Mode::loose;
  bool in_pass_ = false;
  std::uint64_t pass_ = 0;  // number of the last pass
  std::size_t next_step_ = 0, next_buffer_ = 0;

  PageBlock block_;
  std::size_t block_bytes_ = 0, block_users_ = 0;
  std::vector<PageBlock> pieces_, spare_;  // in use; left by others in this pass
  std::size_t pieces_bytes_ = 0, most_pieces_bytes_ = 0, spare_bytes_ = 0;
  std::size_t held_ = 0, peak_ = 0, recordings_ = 0;
};

}  // namespace penumbra::nn
