// A file that is there whole or not at all: it is written under a temporary name beside its final one, takes
// that at commit(), and vanishes where commit() is not reached. A reader sees the old file or the whole new
// one.
//
// A link is followed: what it leads to is replaced, the link stays. What is no plain file, such as /dev/null
// or a pipe, is never replaced but written to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace penumbra::nn {

class FileInTheMaking {
 public:
  // Each function throws Error, naming the path, where the folder is missing, not writable or full, and where
  // the path is a folder's.
  explicit FileInTheMaking(const std::filesystem::path& path);
  ~FileInTheMaking();
  FileInTheMaking(const FileInTheMaking&) = delete;
  FileInTheMaking& operator=(const FileInTheMaking&) = delete;

  void write(const void* data, std::size_t size);
  // `durable`: the bytes reach the disk before the name does, so that a power cut leaves no torn file.
  void commit(bool durable = true);

 private:
  [[noreturn]] void fail() const;

  const std::filesystem::path path_, target_;
  std::filesystem::path temporary_;  // empty: the target is no plain file
  int file_ = -1;
};

// Such a file of text that comes piece by piece: pieces are gathered in 64 kB of memory.
class TextInTheMaking {
 public:
  explicit TextInTheMaking(const std::filesystem::path& path) : file_(path) {}
  // For who appends to it; then flush_if_long().
  std::string& text() { return text_; }
  void flush_if_long() {
    if (text_.size() >= kAtOnce) flush();
  }
  void add(const std::string& text) {
    text_ += text;
    flush_if_long();
  }
  void commit(bool durable = true) {
    flush();
    file_.commit(durable);
  }

 private:
  static constexpr std::size_t kAtOnce = 65536;
  void flush() {
    file_.write(text_.data(), text_.size());
    text_.clear();
  }

  FileInTheMaking file_;
  std::string text_;
};

}  // namespace penumbra::nn
