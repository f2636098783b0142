// Small recordings of robots for tests, put together byte by byte from their specifications.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/bytes.h"

namespace penumbra::test {

enum class Wire { ros1, cdr, cdr_big_endian, cdr2 };

// The fields of a message, one after the other.
class MessageBytes {
 public:
  explicit MessageBytes(Wire wire) : wire_(wire) {}

  template <class Number>
  MessageBytes& number(Number value) {
    const std::size_t most = wire_ == Wire::ros1 ? 1 : wire_ == Wire::cdr2 ? 4 : 8;
    const std::size_t step = std::min(sizeof(Number), most);
    while (bytes_.size() % step != 0) bytes_ += '\0';
    std::string piece = little_endian(value);
    if (wire_ == Wire::cdr_big_endian) std::reverse(piece.begin(), piece.end());
    bytes_ += piece;
    return *this;
  }
  template <class Numbers>
  MessageBytes& numbers(const Numbers& values) {
    for (const double value : values) number(value);
    return *this;
  }
  MessageBytes& list(std::string_view bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
    return *this;
  }
  MessageBytes& text(const std::string& text) { return list(wire_ == Wire::ros1 ? text : text + '\0'); }
  MessageBytes& header(std::int64_t stamp, const std::string& frame) {
    if (wire_ == Wire::ros1) number(std::uint32_t{7});
    number(static_cast<std::uint32_t>(stamp / 1'000'000'000));
    number(static_cast<std::uint32_t>(stamp % 1'000'000'000));
    return text(frame);
  }
  std::string bytes() const {
    switch (wire_) {
      case Wire::ros1:
        return bytes_;
      case Wire::cdr:
        return std::string("\0\1\0\0", 4) + bytes_;
      case Wire::cdr_big_endian:
        return std::string("\0\0\0\0", 4) + bytes_;
      case Wire::cdr2:
        return std::string("\0\7\0\0", 4) + bytes_;
    }
    return {};
  }

 private:
  Wire wire_;
  std::string bytes_;
};

struct ImageParts {
  std::int64_t stamp = 0;
  std::string frame = "camera", encoding = "mono8";
  std::uint32_t width = 0, height = 0, step = 0;
  bool is_big_endian = false;
  std::string data;
};
std::string image_message(Wire wire, const ImageParts& image);
std::string compressed_message(Wire wire, std::int64_t stamp, const std::string& format,
                               const std::string& data);

struct CameraParts {
  std::string frame = "camera", model = "plumb_bob";
  std::uint32_t width = 0, height = 0;
  std::vector<double> D;
  std::array<double, 9> K{}, R{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 12> P{};
  std::array<std::uint32_t, 6> binning_and_roi{};  // binning x, y; roi x, y, height, width
};
// A pinhole camera; `Tx`: P[3].
CameraParts pinhole(std::uint32_t width, std::uint32_t height, double f, double Tx = 0.0);
std::string camera_message(Wire wire, const CameraParts& camera);

// tf2_msgs/TFMessage.
struct TransformParts {
  std::string parent, child;
  std::array<double, 3> at{};
  std::array<double, 4> rotation{0, 0, 0, 1};  // quaternion x y z w
};
std::string transforms_message(Wire wire, const std::vector<TransformParts>& transforms);

struct BagMessage {
  std::string topic, type;  // "sensor_msgs/Image"
  std::int64_t time = 0;    // of recording, nanoseconds
  std::string bytes;
};
// `per_chunk` messages in a chunk, 0: no chunks. Not finished: as a recorder leaves it that was killed.
std::string ros1_bag(const std::vector<BagMessage>& messages, std::size_t per_chunk = 3,
                     bool is_finished = true);
std::string mcap_file(const std::vector<BagMessage>& messages, const std::string& encoding,
                      std::size_t per_chunk = 3, bool is_finished = true);

}  // namespace penumbra::test
