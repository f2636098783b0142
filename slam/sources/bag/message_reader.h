// The fields of a ROS message, one after the other.
//
//   ros1   little-endian, without gaps; a text is u32 length and its bytes
//   cdr    4 bytes that say the byte order, then numbers at multiples of their size (of 4 at most in CDR's
//          second version), counted from behind these 4 bytes; a text's length counts a 0 at its end
//
// Sources: wiki.ros.org/msg; OMG, DDS Interoperability Wire Protocol 2.5, section 10 (encapsulation), and
// DDS-XTypes 1.3, section 7.4.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "slam/sources/bag/message_source.h"

namespace penumbra::slam {

// What std_msgs/Header says.
struct MessageHeader {
  std::int64_t stamp = 0;  // nanoseconds; 0: not set
  std::string_view frame;
};

class MessageReader {
 public:
  // `place` names the message in errors. Throws InputError for an encoding that is neither, for CDR of a kind
  // that plain messages never have, and, as all functions below, where the bytes end too soon.
  MessageReader(std::string_view bytes, MessageEncoding encoding, std::string_view place);

  template <class T>
  T number() {
    align(sizeof(T));
    const std::string_view piece = take(sizeof(T));
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), piece.data(), sizeof(T));
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  template <std::size_t kCount>
  std::array<double, kCount> numbers() {
    std::array<double, kCount> values;
    for (double& value : values) value = number<double>();
    return values;
  }
  std::vector<double> number_list();
  std::string_view text();
  std::string_view byte_list();  // uint8[]
  MessageHeader header();

 private:
  void align(std::size_t size);
  std::string_view take(std::size_t size);

  std::string_view bytes_, place_;
  std::size_t position_ = 0;
  std::size_t most_alignment_ = 1;  // 1: no gaps
  bool is_ros1_, is_swapped_ = false;
};

}  // namespace penumbra::slam
