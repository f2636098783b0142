// A whole file as read-only bytes, through the page cache and without a copy (mmap).
//
// The bytes stay valid as long as the MappedFile lives, also when the file is renamed or removed meanwhile.
// A file that another process cuts short while it is mapped ends the program with SIGBUS, as with every
// memory map: replace files by renaming a finished one over them, as write_safetensors does.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace penumbra {

class MappedFile {
 public:
  // Throws InputError where `path` is missing, unreadable or no regular file (folder, pipe, device).
  static std::shared_ptr<const MappedFile> open(const std::filesystem::path& path);

  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }
  // Takes the pages that lie in `part`, if that is a part of the file, out of the process's memory: for what
  // will hardly be read again. Reading it again is as right as before, and slower.
  void forget(std::span<const std::byte> part) const;

 private:
  MappedFile() = default;

  const std::byte* data_ = nullptr;  // null for an empty file
  std::size_t size_ = 0;
};

}  // namespace penumbra
