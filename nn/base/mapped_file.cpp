#include "nn/base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "nn/base/error.h"

namespace penumbra {

namespace {

struct FileDescriptor {
  int value;
  ~FileDescriptor() {
    if (value >= 0) ::close(value);
  }
};

std::string last_error() { return std::generic_category().message(errno); }

}  // namespace

std::shared_ptr<const MappedFile> MappedFile::open(const std::filesystem::path& path) {
  // O_NONBLOCK: opening a pipe must not wait for its other end.
  const FileDescriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.value < 0) throw InputError(path.string(), "a readable file", last_error());
  struct stat status {};
  if (::fstat(file.value, &status) != 0) throw InputError(path.string(), "a readable file", last_error());
  if (!S_ISREG(status.st_mode)) {
    throw InputError(path.string(), "a regular file",
                     S_ISDIR(status.st_mode) ? "a folder" : "something else");
  }

  std::shared_ptr<MappedFile> mapped(new MappedFile);
  if (status.st_size == 0) return mapped;  // mmap refuses a length of 0
  const auto size = static_cast<std::size_t>(status.st_size);
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.value, 0);
  if (data == MAP_FAILED) throw InputError(path.string(), "a file that can be memory-mapped", last_error());
  mapped->data_ = static_cast<const std::byte*>(data);
  mapped->size_ = size;
  return mapped;
}

void MappedFile::forget(std::span<const std::byte> part) const {
  const auto begin = reinterpret_cast<std::uintptr_t>(data_),
             first = reinterpret_cast<std::uintptr_t>(part.data());
  if (part.empty() || first < begin || first + part.size() > begin + size_) return;
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const std::uintptr_t from = (first + page - 1) / page * page, to = (first + part.size()) / page * page;
  if (from < to) (void)::madvise(reinterpret_cast<void*>(from), to - from, MADV_DONTNEED);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace penumbra
