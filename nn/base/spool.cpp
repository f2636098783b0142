#include "nn/base/spool.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "nn/base/error.h"

namespace penumbra {

namespace {

// -1 where there can be none.
int nameless_file(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path in = folder.empty() ? std::filesystem::temp_directory_path(error) : folder;
#ifdef O_TMPFILE
  const int file = ::open(in.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
#endif
  std::string name = (in / ".spool_XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

SpoolFile::File::~File() { ::close(descriptor); }

void SpoolFile::append(const void* data, std::size_t size) {
  newest_.append(static_cast<const char*>(data), size);
  if (newest_.size() >= kBlock && !is_refused_) flush();
}

void SpoolFile::flush() {
  if (!file_) {
    if (const int opened = nameless_file(folder_); opened >= 0) file_ = std::make_shared<const File>(opened);
  }
  std::size_t done = 0;
  while (file_ && done < newest_.size()) {
    const ssize_t count = ::pwrite(file_->descriptor, newest_.data() + done, newest_.size() - done,
                                   static_cast<off_t>(written_ + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  // What was written in part counts as not written.
  if (done < newest_.size()) {
    is_refused_ = true;
    return;
  }
  written_ += newest_.size();
  newest_.clear();
}

void SpoolFile::read(std::size_t begin, void* to, std::size_t size) const {
  auto* out = static_cast<char*>(to);
  while (size > 0 && begin < written_) {
    const ssize_t count =
        ::pread(file_->descriptor, out, std::min(size, written_ - begin), static_cast<off_t>(begin));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      throw Error(fmt::format("what was kept in {} cannot be read back: {}",
                              folder_.empty() ? "the folder of temporary files" : folder_.string(),
                              count < 0 ? std::strerror(errno) : "it is gone"));
    out += count;
    begin += static_cast<std::size_t>(count);
    size -= static_cast<std::size_t>(count);
  }
  if (size > 0) std::memcpy(out, newest_.data() + (begin - written_), size);
}

}  // namespace penumbra
