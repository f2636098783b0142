// Memory for weights: aligned to a cache line, in blocks on huge pages (nn/base/page_block.h).
//
// The weights of all layers lie one behind the other in blocks of many MB; a block is given back with the
// last of its pieces.
#pragma once

#include <cstddef>
#include <memory>

namespace penumbra::nn {

class WeightMemory {
 public:
  WeightMemory() = default;
  // Contents are undefined. Throws std::bad_alloc. Any thread may ask.
  explicit WeightMemory(std::size_t bytes);

  std::byte* data() const { return data_.get(); }

 private:
  std::shared_ptr<std::byte> data_;  // shares the block
};

}  // namespace penumbra::nn
