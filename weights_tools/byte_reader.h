// Reads little-endian numbers and pieces of an untrusted byte string, never past its end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

namespace penumbra::weights_tools {

class ByteReader {
 public:
  // `on_end(needed)` is called where `needed` more bytes are wanted than there are; it must throw.
  ByteReader(std::span<const std::byte> bytes, std::size_t begin, std::function<void(std::uint64_t)> on_end)
      : bytes_(bytes), position_(begin), on_end_(std::move(on_end)) {}

  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

  std::span<const std::byte> take(std::uint64_t size) {
    if (size > remaining()) on_end_(size);
    const std::span<const std::byte> taken = bytes_.subspan(position_, static_cast<std::size_t>(size));
    position_ += taken.size();
    return taken;
  }

  std::string_view text(std::uint64_t size) {
    const std::span<const std::byte> taken = take(size);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

  template <class Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(sizeof(Number)).data(), sizeof(Number));
    return value;
  }

  // The text up to the next line end, which is passed over; at most `longest` bytes of text.
  std::string_view line(std::size_t longest) {
    const std::string_view rest(reinterpret_cast<const char*>(bytes_.data()) + position_, remaining());
    const std::size_t length = rest.substr(0, longest + 1).find('\n');
    if (length == std::string_view::npos) on_end_(longest + 1);
    position_ += length + 1;
    return rest.substr(0, length);
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_;
  std::function<void(std::uint64_t)> on_end_;
};

}  // namespace penumbra::weights_tools
