// A block of memory straight from the system, on huge pages where it gives them.
//
// On pages of 4 KB every page that is touched for the first time costs a fault, and reading hundreds of MB
// misses the TLB at each; pages of 2 MB take a five-hundredth of both. Where the system does not give them to
// who asks (madvise), the pages are ordinary. Memory is taken when it is touched, so a block may be asked for
// far larger than will be used, and cut when that is known. Contents are zero.
#pragma once

#include <cstddef>
#include <utility>

namespace penumbra {

class PageBlock {
 public:
  PageBlock() = default;
  // Empty where the system has no room for it.
  explicit PageBlock(std::size_t bytes);
  PageBlock(PageBlock&& other) noexcept { *this = std::move(other); }
  PageBlock& operator=(PageBlock&& other) noexcept {
    std::swap(mapped_, other.mapped_);
    std::swap(mapped_bytes_, other.mapped_bytes_);
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~PageBlock();

  bool empty() const { return data_ == nullptr; }
  std::byte* data() const { return data_; }  // a multiple of 2 MB
  std::size_t bytes() const { return bytes_; }
  // Gives back what lies behind the first `bytes`.
  void cut(std::size_t bytes);

 private:
  void* mapped_ = nullptr;
  std::size_t mapped_bytes_ = 0;
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace penumbra
