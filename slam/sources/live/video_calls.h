// The system calls through which a camera is used, so that a test can stand in for the kernel.
#pragma once

#include <sys/types.h>

#include <cstddef>

namespace penumbra::slam {

// As the calls of the same names, with errno. Of those that a signal interrupts control() is made again;
// wait() has then waited; close() is made once, for the kernel has let go of the descriptor whatever it says
// (close(2)), and another thread may have been given its number.
class VideoCalls {
 public:
  virtual ~VideoCalls() = default;
  virtual int open(const char* path) = 0;  // to read and write, without blocking
  virtual void close(int descriptor) = 0;
  virtual int control(int descriptor, unsigned long request, void* argument) = 0;  // ioctl
  // Memory that is shared with the driver; null where that fails.
  virtual void* map(int descriptor, std::size_t bytes, off_t offset) = 0;
  virtual void unmap(void* memory, std::size_t bytes) = 0;
  // Whether there is something to read, or an error, within so many milliseconds.
  virtual bool wait(int descriptor, int milliseconds) = 0;
};

VideoCalls& system_video_calls();

}  // namespace penumbra::slam
