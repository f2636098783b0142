// The records of MCAP files that reader and writer know.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "nn/base/counted.h"
#include "nn/base/error.h"

namespace penumbra::slam {

enum class McapOp : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  statistics = 11,
  summary_offset = 14,
  data_end = 15,
};

// Numbers and texts of a record, one after the other. Throws InputError beyond its end.
class McapFields {
 public:
  McapFields(std::string_view bytes, std::string_view place) : bytes_(bytes), place_(place) {}

  template <class T>
  T number() {
    T value;
    const std::string_view piece = take(sizeof(T));
    std::memcpy(&value, piece.data(), sizeof(T));
    return value;
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size())
      throw InputError(place_, fmt::format("{} in a record", counted(size, "more byte")),
                       fmt::format("{}", bytes_.size()));
    const std::string_view piece = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return piece;
  }
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_, place_;
};

struct McapRecord {
  McapOp op{};
  std::string_view content;
};

// Takes a record off the front; none, and nothing taken, where it is not whole.
inline std::optional<McapRecord> take_mcap_record(std::string_view& bytes) {
  constexpr std::size_t kBefore = 1 + sizeof(std::uint64_t);
  if (bytes.size() < kBefore) return std::nullopt;
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data() + 1, sizeof(length));
  if (length > bytes.size() - kBefore) return std::nullopt;
  const McapRecord record{static_cast<McapOp>(bytes[0]), bytes.substr(kBefore, length)};
  bytes.remove_prefix(kBefore + length);
  return record;
}

}  // namespace penumbra::slam
