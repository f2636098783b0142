#include "nn/layers/weight_memory.h"

#include <algorithm>
#include <mutex>
#include <new>

#include "nn/base/page_block.h"

namespace penumbra::nn {

namespace {

constexpr std::size_t kBlockBytes = std::size_t{32} << 20;  // only what is written takes memory
constexpr std::size_t kLine = 64;

}  // namespace

WeightMemory::WeightMemory(std::size_t bytes) {
  // The block that is being filled; it lives as long as pieces of it do.
  static std::mutex mutex;
  static std::weak_ptr<PageBlock> filling;
  static std::size_t used = 0;

  bytes = (std::max(bytes, std::size_t{1}) + kLine - 1) / kLine * kLine;
  const std::lock_guard lock(mutex);
  std::shared_ptr<PageBlock> block = filling.lock();
  if (block == nullptr || bytes > block->bytes() - used) {
    block = std::make_shared<PageBlock>(std::max(bytes, kBlockBytes));
    if (block->empty()) throw std::bad_alloc();
    filling = block;
    used = 0;
  }
  data_ = std::shared_ptr<std::byte>(block, block->data() + used);
  used += bytes;
}

}  // namespace penumbra::nn
