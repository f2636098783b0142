#include "nn/base/page_block.h"

#include <sys/mman.h>

#include <memory>

namespace penumbra {

namespace {

constexpr std::size_t kPage = 4096, kHugePage = std::size_t{2} << 20;

}  // namespace

PageBlock::PageBlock(std::size_t bytes) {
  if (bytes == 0) return;
  const std::size_t wanted = bytes + kHugePage;  // room to begin at a multiple of it
  void* const mapped =
      ::mmap(nullptr, wanted, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapped == MAP_FAILED) return;
  mapped_ = mapped;
  mapped_bytes_ = wanted;
  void* aligned = mapped;
  std::size_t room = wanted;
  data_ = static_cast<std::byte*>(std::align(kHugePage, bytes, aligned, room));
  bytes_ = bytes;
  (void)::madvise(data_, bytes_, MADV_HUGEPAGE);
}

PageBlock::~PageBlock() {
  if (mapped_ != nullptr) ::munmap(mapped_, mapped_bytes_);
}

void PageBlock::cut(std::size_t bytes) {
  if (bytes >= bytes_) return;
  bytes_ = bytes;
  std::byte* const begin = static_cast<std::byte*>(mapped_);
  const auto keep = static_cast<std::size_t>(data_ - begin) + (bytes + kPage - 1) / kPage * kPage;
  if (keep >= mapped_bytes_) return;
  ::munmap(begin + keep, mapped_bytes_ - keep);
  mapped_bytes_ = keep;
}

}  // namespace penumbra
