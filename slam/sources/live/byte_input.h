// Bytes from a pipe, a socket or a file, without blocking for longer than a tenth of a second: whoever waits
// can be stopped.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace penumbra::slam {

class ByteInput {
 public:
  // `descriptor` stays the caller's. `name`: for messages.
  ByteInput(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}

  // Ends all waiting, from any thread; what is read then ends as if the input had.
  void stop() { stopped_ = true; }
  // As many of `count` bytes as come before the input ends. Throws Error where reading fails.
  std::size_t read(std::uint8_t* to, std::size_t count);
  // The bytes before the next line end; none where the input ends before. Throws InputError for more than
  // `longest`.
  std::optional<std::string> read_line(std::size_t longest);
  const std::string& name() const { return name_; }
  std::uint64_t position() const { return position_; }  // bytes read so far

 private:
  bool fill();

  const int descriptor_;
  const std::string name_;
  std::atomic<bool> stopped_{false};
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(1U << 16U);
  std::size_t begin_ = 0, end_ = 0;  // of what waits in the buffer
  std::uint64_t position_ = 0;
};

}  // namespace penumbra::slam
