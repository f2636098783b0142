// Plain values and arrays as little-endian bytes, one after the other; for file formats of our own.
#pragma once

#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "nn/base/counted.h"
#include "nn/base/error.h"

namespace penumbra {

static_assert(std::endian::native == std::endian::little, "files are little-endian, as all x86 is");

class ByteWriter {
 public:
  template <typename T>
  void put(const T& value) {
    put_array(std::span<const T>(&value, 1));
  }
  template <typename T>
  void put_array(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (!values.empty()) bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Never reads beyond the end, and never asks for memory that the bytes cannot fill.
class ByteReader {
 public:
  // `place` names the file in errors; `offset` is where `bytes` begin in it. Both must outlive the reader.
  ByteReader(std::string_view bytes, std::string_view place, std::size_t offset = 0)
      : bytes_(bytes), place_(place), offset_(offset) {}

  template <typename T>
  T get(std::string_view what) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::string_view piece = take(1, sizeof(T), what);
    T value;
    std::memcpy(&value, piece.data(), sizeof(T));
    return value;
  }
  template <typename T>
  std::vector<T> get_array(std::size_t count, std::string_view what) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::string_view piece = take(count, sizeof(T), what);
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), piece.data(), piece.size());
    return values;
  }
  // A count of things of which each takes at least `least_bytes`.
  std::uint32_t get_count(std::size_t least_bytes, std::string_view what) {
    const std::uint32_t count = get<std::uint32_t>(what);
    if (count > remaining() / least_bytes) {
      throw InputError(here(), fmt::format("{} that fit into the {} bytes left", what, remaining()),
                       fmt::format("{}", count));
    }
    return count;
  }

  double get_finite(std::string_view what) {
    const double value = get<double>(what);
    if (!std::isfinite(value)) refuse(fmt::format("a finite {}", what), fmt::format("{}", value));
    return value;
  }
  // Throws InputError about what was just read.
  [[noreturn]] void refuse(std::string_view expected, std::string_view found) const {
    throw InputError(fmt::format("before {}", here()), expected, found);
  }

  // Throws InputError unless all of `what` was read.
  void expect_end(std::string_view what) const {
    if (remaining() > 0)
      throw InputError(here(), fmt::format("the end of {}", what), counted(remaining(), "more byte"));
  }

  std::size_t remaining() const { return bytes_.size() - position_; }
  // The place of the next byte, for messages.
  std::string here() const { return fmt::format("{}, byte {}", place_, offset_ + position_); }

 private:
  std::string_view take(std::size_t count, std::size_t size, std::string_view what) {
    if (count > remaining() / size) {
      throw InputError(here(), fmt::format("{} ({} bytes)", what, count * size),
                       fmt::format("{} bytes until the end", remaining()));
    }
    const std::string_view piece = bytes_.substr(position_, count * size);
    position_ += piece.size();
    return piece;
  }

  std::string_view bytes_, place_;
  std::size_t offset_, position_ = 0;
};

}  // namespace penumbra
