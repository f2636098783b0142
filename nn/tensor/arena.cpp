#include "nn/tensor/arena.h"

#include <algorithm>
#include <new>
#include <utility>

#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

constexpr std::size_t kAlignment = 64;  // a cache line, and the widest vector
// Schedules that are remembered: enough for a few cameras and networks; the one unused for longest is
// forgotten.
constexpr std::size_t kMostSchedules = 16;
// Smaller buffers of a pass that is recorded are allocated as any others are.
constexpr std::size_t kLeastPiece = std::size_t{256} << 10;

float* allocate_memory(std::size_t bytes) {
  return static_cast<float*>(::operator new (bytes, std::align_val_t{kAlignment}));
}

void free_memory(float* data) { ::operator delete (data, std::align_val_t{kAlignment}); }

}  // namespace

ArenaBuffer& ArenaBuffer::operator=(ArenaBuffer&& other) noexcept {
  if (this == &other) return *this;
  release();
  arena_ = std::exchange(other.arena_, nullptr);
  data_ = std::exchange(other.data_, nullptr);
  bytes_ = other.bytes_;
  index_ = other.index_;
  pass_ = other.pass_;
  in_block_ = other.in_block_;
  in_piece_ = other.in_piece_;
  return *this;
}

void ArenaBuffer::release() {
  if (arena_ != nullptr) arena_->release(*this);
  arena_ = nullptr;
}

Arena::Pass::Pass(Arena& arena, const void* network, int height, int width)
    : arena_(arena.in_pass_ ? nullptr : &arena) {
  if (arena_ != nullptr) arena_->begin({network, height, width, thread_count()});
}

Arena::Pass::~Pass() {
  if (arena_ != nullptr) arena_->end();
}

void Arena::begin(const Key& key) {
  in_pass_ = true;
  ++pass_;
  next_step_ = next_buffer_ = 0;
  // Somebody still holds a buffer of an earlier pass: its place in the block is taken.
  if (block_users_ > 0) return;

  const auto known = std::find_if(schedules_.begin(), schedules_.end(),
                                  [&](const Schedule& schedule) { return schedule.key == key; });
  current_ = static_cast<std::size_t>(known - schedules_.begin());
  if (known != schedules_.end()) {
    mode_ = Mode::replaying;
  } else {
    mode_ = Mode::recording;
    ++recordings_;
    if (schedules_.size() < kMostSchedules) {
      schedules_.emplace_back();
    } else {
      current_ = static_cast<std::size_t>(
          std::min_element(schedules_.begin(), schedules_.end(),
                           [](const Schedule& a, const Schedule& b) { return a.last_pass < b.last_pass; }) -
          schedules_.begin());
      schedules_[current_] = {};
    }
    schedules_[current_].key = key;
    free_block();  // else the pass would need both
    most_pieces_bytes_ = 0;
  }
  schedules_[current_].last_pass = pass_;
}

void Arena::end() {
  if (mode_ == Mode::recording) {
    try {
      make_plan(schedules_[current_]);
      spare_.clear();
      spare_bytes_ = 0;
      make_block();
    } catch (const std::bad_alloc&) {
      schedules_[current_].key = {};  // without a plan, then
    }
  }
  mode_ = Mode::loose;
  in_pass_ = false;
}

void Arena::make_plan(Schedule& schedule) const {
  std::vector<BufferLifetime> buffers(next_buffer_);
  for (std::size_t t = 0; t < schedule.steps.size(); ++t) {
    const Step& step = schedule.steps[t];
    if (step.bytes > 0) {
      buffers[step.buffer] = {step.bytes, t, schedule.steps.size()};
    } else {
      buffers[step.buffer].last = t;
    }
  }
  schedule.plan = plan_memory(buffers);
}

void Arena::step(const Step& step) {
  if (mode_ == Mode::loose) return;
  Schedule& schedule = schedules_[current_];
  if (mode_ == Mode::recording) {
    schedule.steps.push_back(step);
    return;
  }
  if (next_step_ < schedule.steps.size() && schedule.steps[next_step_] == step) {
    ++next_step_;
    return;
  }
  mode_ = Mode::loose;
  schedule.key = {};  // the next pass of this shape finds none
}

ArenaBuffer Arena::allocate(std::size_t count) {
  if (mode_ == Mode::recording) {
    // Room for two steps a buffer, so that noting a release cannot fail.
    std::vector<Step>& steps = schedules_[current_].steps;
    if (steps.capacity() < 2 * (next_buffer_ + 1)) steps.reserve(4 * (next_buffer_ + 1));
  }
  ArenaBuffer buffer;
  buffer.bytes_ =
      std::max((count * sizeof(float) + kAlignment - 1) / kAlignment, std::size_t{1}) * kAlignment;
  if (in_pass_) {
    buffer.pass_ = pass_;
    buffer.index_ = next_buffer_++;
    step({buffer.index_, buffer.bytes_});
  }
  if (mode_ == Mode::replaying) {
    buffer.data_ = reinterpret_cast<float*>(block_.data() + schedules_[current_].plan.offsets[buffer.index_]);
    buffer.in_block_ = true;
    ++block_users_;
  } else {
    if (mode_ == Mode::recording) buffer.data_ = take_piece(buffer.bytes_);
    buffer.in_piece_ = buffer.data_ != nullptr;
    if (!buffer.in_piece_) buffer.data_ = allocate_memory(buffer.bytes_);
    hold(buffer.bytes_);
  }
  buffer.arena_ = this;
  return buffer;
}

void Arena::release(const ArenaBuffer& buffer) {
  if (in_pass_ && buffer.pass_ == pass_) step({buffer.index_, 0});
  if (buffer.in_block_) {
    --block_users_;
    return;
  }
  if (buffer.in_piece_) {
    leave_piece(buffer.data_);
  } else {
    free_memory(buffer.data_);
  }
  held_ -= buffer.bytes_;
}

float* Arena::take_piece(std::size_t bytes) {
  if (bytes < kLeastPiece) return nullptr;
  // The smallest spare one that is large enough, cut; memory that was touched costs no page fault.
  const auto fits = [&](const PageBlock& piece) { return piece.bytes() >= bytes; };
  auto best = std::find_if(spare_.begin(), spare_.end(), fits);
  for (auto other = best; other != spare_.end(); ++other) {
    if (fits(*other) && other->bytes() < best->bytes()) best = other;
  }
  PageBlock piece;
  if (best != spare_.end()) {
    piece = std::move(*best);
    spare_.erase(best);
    spare_bytes_ -= piece.bytes();
    piece.cut(bytes);
  } else {
    piece = PageBlock(bytes);
    if (piece.empty()) return nullptr;
  }
  spare_.reserve(pieces_.size() + spare_.size() + 1);  // so that leaving it cannot fail
  pieces_bytes_ += bytes;
  most_pieces_bytes_ = std::max(most_pieces_bytes_, pieces_bytes_);
  while (pieces_bytes_ + spare_bytes_ > most_pieces_bytes_) {
    spare_bytes_ -= spare_.front().bytes();
    spare_.erase(spare_.begin());
  }
  pieces_.push_back(std::move(piece));
  return reinterpret_cast<float*>(pieces_.back().data());
}

void Arena::leave_piece(float* data) {
  const auto found = std::find_if(pieces_.begin(), pieces_.end(), [&](const PageBlock& piece) {
    return reinterpret_cast<float*>(piece.data()) == data;
  });
  pieces_bytes_ -= found->bytes();
  if (mode_ == Mode::recording) {
    spare_bytes_ += found->bytes();
    spare_.push_back(std::move(*found));
  }
  pieces_.erase(found);
}

void Arena::make_block() {
  for (const Schedule& schedule : schedules_) block_bytes_ = std::max(block_bytes_, schedule.plan.bytes);
  if (block_bytes_ == 0) return;
  block_ = PageBlock(block_bytes_);
  if (block_.empty()) {
    block_bytes_ = 0;
    throw std::bad_alloc();
  }
  hold(block_bytes_);
}

void Arena::free_block() {
  block_ = PageBlock();
  held_ -= std::exchange(block_bytes_, 0);
}

void Arena::hold(std::size_t bytes) {
  held_ += bytes;
  peak_ = std::max(peak_, held_);
}

}  // namespace penumbra::nn
