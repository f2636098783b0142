// The fields of a ROS 2 message as bytes: little-endian CDR (message_reader.h has its rules).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "nn/base/byte_stream.h"

namespace penumbra::slam {

class MessageWriter {
 public:
  template <class T>
  void number(T value) {
    const std::size_t beyond = bytes_.bytes().size() % sizeof(T);
    for (std::size_t i = beyond; beyond > 0 && i < sizeof(T); ++i) bytes_.put(char{0});
    bytes_.put(value);
  }
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.put_array(std::span<const char>(text));
    bytes_.put(char{0});
  }
  void byte_list(std::string_view list) {
    number(static_cast<std::uint32_t>(list.size()));
    bytes_.put_array(std::span<const char>(list));
  }
  // Nanoseconds.
  void header(std::int64_t stamp, std::string_view frame) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    number(static_cast<std::int32_t>(stamp / kSecond));
    number(static_cast<std::uint32_t>(stamp % kSecond));
    text(frame);
  }

  std::string bytes() const { return std::string("\0\1\0\0", 4) + bytes_.bytes(); }

 private:
  ByteWriter bytes_;
};

}  // namespace penumbra::slam
