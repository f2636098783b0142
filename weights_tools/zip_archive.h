// A zip file's entries, read from memory with zlib.
//
//   [local header, name, extra, data] ... [central directory] [zip64 end, its locator] [end of directory]
//
// The end record, the last 22 bytes before an optional comment, says where the directory lies; its entries
// say where each local header lies. Sizes and places of 2^32 - 1 stand in the extra field 0x0001 (zip64)
// instead. Source: PKWARE, .ZIP File Format Specification (APPNOTE.TXT) 6.3, sections 4.3 to 4.5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "weights_tools/torch_storages.h"

namespace penumbra::weights_tools {

struct ZipEntry {
  std::uint64_t data = 0;         // where its bytes begin in the file
  std::uint64_t packed_size = 0;  // bytes in the file
  std::uint64_t size = 0;         // bytes when unpacked; checked against what the packed bytes can hold
  std::uint32_t crc = 0;          // of the unpacked bytes
  bool deflated = false;
};

class ZipArchive {
 public:
  // `bytes` must outlive the archive. Throws InputError where they are not a whole zip file whose directory
  // and local headers agree, an entry's name stands twice, an entry is encrypted or neither stored nor
  // deflated, or its claimed size is impossible.
  ZipArchive(std::span<const std::byte> bytes, std::string place);

  const std::map<std::string, ZipEntry, std::less<>>& entries() const { return entries_; }

  struct Bytes {
    std::span<const std::byte> bytes;
    std::shared_ptr<const void> owner;  // null where they lie in the archive
  };
  // All bytes of an entry, of a stored one where they lie; throws InputError where it is damaged (its check
  // sum is verified).
  Bytes read(const std::string& name, const ZipEntry& entry, MemoryBudget& budget) const;

 private:
  struct Directory {
    std::uint64_t begin, size, entries;
  };
  Directory find_directory() const;
  void list_entries(const Directory& directory);
  std::uint64_t number(std::uint64_t at, int size) const;
  bool holds(std::uint64_t at, std::uint64_t size) const;
  std::string entry_place(std::string_view name) const;
  [[noreturn]] void refuse(std::string_view found) const;

  std::string_view bytes_;
  std::string place_;
  std::map<std::string, ZipEntry, std::less<>> entries_;
};

}  // namespace penumbra::weights_tools
