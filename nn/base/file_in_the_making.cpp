#include "nn/base/file_in_the_making.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

namespace fs = std::filesystem;

// Where links lead, which need not exist.
fs::path behind_links(fs::path path) {
  constexpr int kMostLinks = 40;  // as Linux follows
  std::error_code none;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, none); ++i)
    path = path.parent_path() / fs::read_symlink(path, none);
  return path;
}

// Unique among the threads of this process and among processes of this machine.
fs::path temporary_name(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  fs::path name = path;
  name += fmt::format(".{}.{}.part", getpid(), counter.fetch_add(1));
  return name;
}

}  // namespace

FileInTheMaking::FileInTheMaking(const fs::path& path) : path_(path), target_(behind_links(path)) {
  std::error_code none;
  const fs::file_status status = fs::status(target_, none);
  if (fs::is_directory(status))
    throw Error(fmt::format("{}: cannot be written: it is a folder", path.string()));
  const bool is_special = fs::exists(status) && !fs::is_regular_file(status);
  if (!is_special) temporary_ = temporary_name(target_);
  file_ = is_special ? open(target_.c_str(), O_WRONLY | O_CLOEXEC)
                     : open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) {
    temporary_.clear();
    fail();
  }
}

FileInTheMaking::~FileInTheMaking() {
  if (file_ >= 0) close(file_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void FileInTheMaking::write(const void* data, std::size_t size) {
  constexpr std::size_t kLargestWrite = std::size_t{1} << 30;  // Linux writes at most 2 GiB at once
  const char* next = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = ::write(file_, next, std::min(size, kLargestWrite));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail();
    next += written;
    size -= static_cast<std::size_t>(written);
  }
}

void FileInTheMaking::commit(bool durable) {
  // EINVAL: a device, or a file system that has no such promise to give.
  if (durable && fsync(file_) != 0 && errno != EINVAL) fail();
  if (close(std::exchange(file_, -1)) != 0) fail();  // where a network disk says that it is full
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail();
  temporary_.clear();
}

void FileInTheMaking::fail() const {
  const int error = errno;
  throw Error(
      fmt::format("{}: cannot be written: {}", path_.string(), std::generic_category().message(error)));
}

}  // namespace penumbra::nn
