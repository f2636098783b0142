#include "slam/sources/bag/message_reader.h"

#include <algorithm>

#include "nn/base/counted.h"
#include "nn/base/error.h"

namespace penumbra::slam {

MessageReader::MessageReader(std::string_view bytes, MessageEncoding encoding, std::string_view place)
    : bytes_(bytes), place_(place), is_ros1_(encoding == MessageEncoding::ros1) {
  if (is_ros1_) return;
  if (encoding != MessageEncoding::cdr)
    throw InputError(place, "a message in the encoding ros1 or cdr", "another");
  constexpr std::size_t kBefore = 4;
  const std::string_view kind = take(kBefore);
  const auto representation = static_cast<unsigned char>(kind[1]);
  const bool is_first = representation <= 1, is_second = representation == 6 || representation == 7;
  if (kind[0] != 0 || (!is_first && !is_second)) {
    constexpr std::string_view kZstd("\x28\xB5\x2F\xFD", 4);
    throw InputError(place, "plain CDR",
                     kind == kZstd ? "a message packed by zstd (rosbag2's compression_mode message)"
                                   : fmt::format("representation {:02x}{:02x}",
                                                 static_cast<unsigned char>(kind[0]), representation));
  }
  most_alignment_ = is_first ? 8 : 4;
  is_swapped_ = representation % 2 == 0;
  bytes_.remove_prefix(kBefore);
  position_ = 0;
}

void MessageReader::align(std::size_t size) {
  const std::size_t step = std::min(size, most_alignment_);
  const std::size_t gap = (step - position_ % step) % step;
  if (gap > 0) take(gap);
}

std::string_view MessageReader::take(std::size_t size) {
  if (size > bytes_.size() - position_) {
    throw InputError(place_, fmt::format("{} of the message", counted(size, "more byte")),
                     fmt::format("{}", bytes_.size() - position_));
  }
  const std::string_view piece = bytes_.substr(position_, size);
  position_ += size;
  return piece;
}

std::string_view MessageReader::byte_list() { return take(number<std::uint32_t>()); }

std::string_view MessageReader::text() {
  std::string_view text = byte_list();
  if (!is_ros1_ && text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

std::vector<double> MessageReader::number_list() {
  const auto count = number<std::uint32_t>();
  if (count > (bytes_.size() - position_) / sizeof(double))
    throw InputError(place_, "numbers that fit into the message", fmt::format("{}", count));
  std::vector<double> values(count);
  for (double& value : values) value = number<double>();
  return values;
}

MessageHeader MessageReader::header() {
  if (is_ros1_) number<std::uint32_t>();  // sequence
  const auto seconds = number<std::int32_t>();
  const auto nanoseconds = number<std::uint32_t>();
  MessageHeader header;
  // ROS 1 counts seconds without a sign.
  const std::int64_t whole =
      is_ros1_ ? static_cast<std::int64_t>(static_cast<std::uint32_t>(seconds)) : seconds;
  header.stamp = whole * 1'000'000'000 + nanoseconds;
  header.frame = text();
  return header;
}

}  // namespace penumbra::slam
