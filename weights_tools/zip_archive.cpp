#include "weights_tools/zip_archive.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "nn/base/crc32.h"
#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::uint64_t kLocalHeader = 30, kDirectoryHeader = 46, kEnd = 22, kZip64Locator = 20,
                        kZip64End = 56;
constexpr std::uint64_t kLongestComment = 65535;
constexpr std::uint64_t kIn64Bits = 0xFFFFFFFF;            // the number stands in the zip64 field
constexpr std::uint64_t kEncrypted = 1, kSizesFollow = 8;  // flags
constexpr std::uint64_t kStored = 0, kDeflated = 8;        // methods
// Deflate packs at most 258 bytes into 2 bits.
constexpr std::uint64_t kBestDeflate = 1032;

constexpr std::string_view kEndMark("PK\5\6", 4), kZip64LocatorMark("PK\6\7", 4), kZip64EndMark("PK\6\6", 4),
    kDirectoryMark("PK\1\2", 4), kLocalMark("PK\3\4", 4);

// Unpacks `packed` to exactly `size` bytes; says what is wrong where that fails.
std::string unpack(std::string_view packed, std::byte* out, std::uint64_t size) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return "no memory to unpack it";
  const auto piece = [](std::uint64_t bytes) {
    return static_cast<uInt>(std::min<std::uint64_t>(bytes, std::numeric_limits<uInt>::max()));
  };
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib only reads it
  std::uint64_t in_left = packed.size(), out_left = size;
  Byte beyond = 0;  // an entry that goes on after `size` bytes writes here
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = out_left > 0 ? reinterpret_cast<Bytef*>(out + (size - out_left)) : &beyond;
    const uInt room = out_left > 0 ? piece(out_left) : 1, given = piece(in_left);
    stream.avail_out = room;
    stream.avail_in = given;
    status = inflate(&stream, Z_NO_FLUSH);
    in_left -= given - stream.avail_in;
    const uInt written = room - stream.avail_out;
    if (out_left == 0 && written > 0) status = Z_DATA_ERROR;
    out_left -= std::min<std::uint64_t>(out_left, written);
  }
  const std::string words = stream.msg != nullptr ? stream.msg : "damaged compressed data";
  inflateEnd(&stream);
  if (status == Z_STREAM_END && out_left == 0) return in_left == 0 ? "" : "bytes after its compressed data";
  return status == Z_STREAM_END || status == Z_BUF_ERROR ? "compressed data that end too early or too late"
                                                         : words;
}

}  // namespace

std::uint64_t ZipArchive::number(std::uint64_t at, int size) const {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes_.data() + at, static_cast<std::size_t>(size));  // little-endian, as x86 is
  return value;
}

bool ZipArchive::holds(std::uint64_t at, std::uint64_t size) const {
  return at <= bytes_.size() && size <= bytes_.size() - at;
}

std::string ZipArchive::entry_place(std::string_view name) const {
  return fmt::format("{}: {}", place_, printable(name));
}

void ZipArchive::refuse(std::string_view found) const {
  throw InputError(place_, "a whole zip file (truncated or damaged?)", found);
}

ZipArchive::ZipArchive(std::span<const std::byte> bytes, std::string place)
    : bytes_(reinterpret_cast<const char*>(bytes.data()), bytes.size()), place_(std::move(place)) {
  list_entries(find_directory());
}

ZipArchive::Directory ZipArchive::find_directory() const {
  const std::uint64_t size = bytes_.size();
  if (size < kEnd) refuse("no end of a zip directory");
  // The end record's comment must reach to the file's end, so that a mark inside a comment is none.
  std::uint64_t end = size - kEnd;
  const std::uint64_t first = end - std::min(end, kLongestComment);
  while (bytes_.substr(end, 4) != kEndMark || end + kEnd + number(end + 20, 2) != size) {
    if (end == first) refuse("no end of a zip directory");
    --end;
  }
  Directory directory{number(end + 16, 4), number(end + 12, 4), number(end + 10, 2)};
  const std::uint64_t disk = number(end + 4, 2);
  std::uint64_t directory_end = end;
  if (end >= kZip64Locator && bytes_.substr(end - kZip64Locator, 4) == kZip64LocatorMark) {
    const std::uint64_t record = number(end - kZip64Locator + 8, 8);
    if (!holds(record, kZip64End) || bytes_.substr(record, 4) != kZip64EndMark) refuse("no zip64 record");
    directory = {number(record + 48, 8), number(record + 40, 8), number(record + 32, 8)};
    directory_end = record;
  } else if (disk != 0) {
    refuse("a part of a zip file in several parts");
  }
  if (!holds(directory.begin, directory.size) || directory.begin + directory.size != directory_end) {
    refuse("a directory that does not end where its end record begins");
  }
  return directory;
}

void ZipArchive::list_entries(const Directory& directory) {
  std::uint64_t at = directory.begin;
  const std::uint64_t end = directory.begin + directory.size;
  for (std::uint64_t i = 0; i < directory.entries; ++i) {
    if (end - at < kDirectoryHeader || bytes_.substr(at, 4) != kDirectoryMark) {
      refuse(fmt::format("a directory without its entry {}", i));
    }
    const std::uint64_t flags = number(at + 8, 2), method = number(at + 10, 2);
    const std::uint64_t name_size = number(at + 28, 2), extra_size = number(at + 30, 2);
    const std::uint64_t whole = kDirectoryHeader + name_size + extra_size + number(at + 32, 2);
    if (end - at < whole) refuse(fmt::format("a directory that ends within its entry {}", i));
    const std::string_view name = bytes_.substr(at + kDirectoryHeader, name_size);
    const std::string where = entry_place(name);
    ZipEntry entry;
    entry.crc = static_cast<std::uint32_t>(number(at + 16, 4));
    entry.packed_size = number(at + 20, 4);
    entry.size = number(at + 24, 4);
    entry.deflated = method == kDeflated;
    std::uint64_t header = number(at + 42, 4);

    std::uint64_t field = at + kDirectoryHeader + name_size;
    const std::uint64_t fields_end = field + extra_size;
    while (fields_end - field >= 4) {
      const std::uint64_t kind = number(field, 2), size = number(field + 2, 2);
      if (size > fields_end - field - 4) throw InputError(where, "whole extra fields", "a torn one");
      if (kind == 1) {
        std::uint64_t next = field + 4;
        for (std::uint64_t* value : {&entry.size, &entry.packed_size, &header}) {
          if (*value != kIn64Bits) continue;
          if (field + 4 + size - next < 8) throw InputError(where, "64-bit sizes", "a field that lacks them");
          *value = number(next, 8);
          next += 8;
        }
      }
      field += 4 + size;
    }

    if (!entry.deflated && method != kStored) {
      throw InputError(where, "a stored or deflated entry", fmt::format("compression method {}", method));
    }
    if ((flags & kEncrypted) != 0) throw InputError(where, "an entry that can be read", "an encrypted one");
    if (!holds(header, kLocalHeader) || bytes_.substr(header, 4) != kLocalMark) {
      throw InputError(where, "its data where the directory says", "no local header there");
    }
    const std::uint64_t local_flags = number(header + 6, 2), local_name = number(header + 26, 2);
    entry.data = header + kLocalHeader + local_name + number(header + 28, 2);
    const bool agrees = number(header + 8, 2) == method && holds(header + kLocalHeader, local_name) &&
                        bytes_.substr(header + kLocalHeader, local_name) == name &&
                        ((local_flags & kSizesFollow) != 0 || number(header + 14, 4) == entry.crc);
    if (!agrees) throw InputError(where, "a local header that agrees with the directory", "another one");
    if (!holds(entry.data, entry.packed_size) || entry.data + entry.packed_size > directory.begin) {
      throw InputError(where, fmt::format("an entry within the file's {} bytes", bytes_.size()),
                       fmt::format("{} bytes at byte {}", entry.packed_size, entry.data));
    }
    if (!entry.deflated && entry.size != entry.packed_size) {
      throw InputError(where, fmt::format("{} bytes, as are stored", entry.packed_size),
                       fmt::format("a claim of {}", entry.size));
    }
    const std::uint64_t largest = entry.packed_size * (entry.deflated ? kBestDeflate : 1);
    if (entry.size > largest) {
      throw InputError(where, fmt::format("at most {} bytes from {} packed ones", largest, entry.packed_size),
                       fmt::format("a claim of {}", entry.size));
    }
    if (!entries_.try_emplace(std::string(name), entry).second) {
      throw InputError(where, "every entry once", "two of this name");
    }
    at += whole;
  }
  if (at != end) refuse("a directory with more entries than it counts");
}

ZipArchive::Bytes ZipArchive::read(const std::string& name, const ZipEntry& entry,
                                   MemoryBudget& budget) const {
  const std::string where = entry_place(name);
  std::string_view bytes = bytes_.substr(entry.data, entry.packed_size);
  std::shared_ptr<std::byte[]> buffer;
  if (entry.deflated) {
    budget.take(entry.size, where);
    buffer = make_buffer(entry.size);
    const std::string problem = unpack(bytes, buffer.get(), entry.size);
    if (!problem.empty()) throw InputError(where, "an undamaged zip entry", problem);
    bytes = {reinterpret_cast<const char*>(buffer.get()), entry.size};
  }
  const std::uint32_t crc = nn::crc32(bytes);
  if (crc != entry.crc) {
    throw InputError(where, "an undamaged zip entry",
                     fmt::format("check sum {:08x} instead of {:08x}", crc, entry.crc));
  }
  return {std::as_bytes(std::span(bytes)), buffer};
}

}  // namespace penumbra::weights_tools
