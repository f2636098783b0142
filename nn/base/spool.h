// A sequence of plain values that grows without end and holds its memory: the newest are in memory, the rest
// in a file without a name, which is gone with the program however it ends.
//
//   Spool<Row> rows(folder);
//   rows.push_back(row);
//   for (const Row& row : rows) ...         in their order, a block at a time
//   rows[i]                                  any of them; cheap where i is near the last one asked for
//
// The file is made when the first block is full. Where the folder takes none, or its disk is full, the values
// stay in memory: nothing is lost. Memory: a block of 64 kB, and one more for whoever reads. One thread at a
// time, readers included.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace penumbra {

// Bytes, of which the first are on disk.
class SpoolFile {
 public:
  static constexpr std::size_t kBlock = 65536;

  explicit SpoolFile(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  void append(const void* data, std::size_t size);
  std::size_t size() const { return written_ + newest_.size(); }
  // How many of them are on disk.
  std::size_t written() const { return written_; }
  // Throws Error where the disk does not give back what it took.
  void read(std::size_t begin, void* to, std::size_t size) const;

 private:
  void flush();

  const std::filesystem::path folder_;
  int file_ = -1;
  bool is_refused_ = false;  // no file, or a full disk: all else stays in memory
  std::size_t written_ = 0;
  std::string newest_;
};

template <class Value>
class Spool {
  static_assert(std::is_trivially_copyable_v<Value>);

  // What was read last.
  struct Window {
    std::size_t begin = 0;
    std::vector<Value> values;
  };

 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Value;
    using difference_type = std::ptrdiff_t;
    using pointer = const Value*;
    using reference = const Value&;

    Iterator(const Spool& spool, std::size_t at) : spool_(&spool), at_(at) {}
    reference operator*() { return spool_->at(at_, window_); }
    pointer operator->() { return &**this; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const Spool* spool_;
    std::size_t at_;
    typename Spool::Window window_;
  };

  // `folder`: where the file may lie; the system's for temporary files unless it is said.
  explicit Spool(std::filesystem::path folder = {})
      : bytes_(std::make_unique<SpoolFile>(std::move(folder))) {}

  void push_back(const Value& value) { bytes_->append(&value, sizeof value); }
  std::size_t size() const { return bytes_->size() / sizeof(Value); }
  bool empty() const { return size() == 0; }
  Value operator[](std::size_t i) const { return at(i, window_); }
  Value back() const { return (*this)[size() - 1]; }
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }
  std::size_t bytes_on_disk() const { return bytes_->written(); }

 private:
  static constexpr std::size_t kAtOnce = SpoolFile::kBlock / sizeof(Value) + 1;

  const Value& at(std::size_t i, Window& window) const {
    if (i < window.begin || i >= window.begin + window.values.size()) {
      window.begin = i - i % kAtOnce;
      window.values.resize(std::min(kAtOnce, size() - window.begin));
      bytes_->read(window.begin * sizeof(Value), window.values.data(), window.values.size() * sizeof(Value));
    }
    return window.values[i - window.begin];
  }

  std::unique_ptr<SpoolFile> bytes_;
  mutable Window window_;
};

}  // namespace penumbra
