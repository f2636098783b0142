#include "slam/sources/live/byte_input.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr int kPatience = 100;  // milliseconds until it is looked whether to stop

}  // namespace

bool ByteInput::fill() {
  while (!stopped_) {
    pollfd waiting{descriptor_, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, kPatience);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = ready < 0 ? -1 : ::read(descriptor_, buffer_.data(), buffer_.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) throw Error(fmt::format("{}: cannot be read: {}", name_, std::strerror(errno)));
    begin_ = 0;
    end_ = static_cast<std::size_t>(count);
    return count > 0;
  }
  return false;
}

std::size_t ByteInput::read(std::uint8_t* to, std::size_t count) {
  std::size_t done = 0;
  while (done < count) {
    if (begin_ == end_ && !fill()) break;
    const std::size_t part = std::min(count - done, end_ - begin_);
    std::memcpy(to + done, buffer_.data() + begin_, part);
    begin_ += part;
    done += part;
  }
  position_ += done;
  return done;
}

std::optional<std::string> ByteInput::read_line(std::size_t longest) {
  std::string line;
  std::uint8_t byte = 0;
  while (read(&byte, 1) == 1) {
    if (byte == '\n') return line;
    if (line.size() == longest)
      throw InputError(fmt::format("{}, byte {}", name_, position_),
                       fmt::format("a line of at most {} bytes", longest), "a longer one");
    line += static_cast<char>(byte);
  }
  return std::nullopt;
}

}  // namespace penumbra::slam
