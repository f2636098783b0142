// A zip file's entries, read through libzip from memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "weights_tools/torch_storages.h"

struct zip;

namespace penumbra::weights_tools {

struct ZipEntry {
  std::uint64_t index = 0;
  std::uint64_t size = 0;  // bytes when unpacked; checked against what the packed bytes can hold
};

class ZipArchive {
 public:
  // `bytes` must outlive the archive. Throws InputError where they are not a whole, consistent zip file, an
  // entry's name stands twice, an entry is neither stored nor deflated, or its claimed size is impossible.
  ZipArchive(std::span<const std::byte> bytes, std::string place);
  ~ZipArchive();
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  const std::map<std::string, ZipEntry, std::less<>>& entries() const { return entries_; }

  // All bytes of an entry; throws InputError where it is damaged (its check sum is verified).
  std::shared_ptr<std::byte[]> read(const std::string& name, const ZipEntry& entry,
                                    MemoryBudget& budget) const;

 private:
  void list_entries(std::uint64_t file_size);

  std::string place_;
  ::zip* archive_ = nullptr;
  std::map<std::string, ZipEntry, std::less<>> entries_;
};

}  // namespace penumbra::weights_tools
