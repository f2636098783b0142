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
//
// A copy is what there was when it was made: it shares the file, of which it knows the part that never
// changes again, so that another thread may read it while the first goes on. What is appended to a copy stays
// in memory.
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
  SpoolFile(const SpoolFile& other)
      : folder_(other.folder_),
        file_(other.file_),
        is_refused_(true),
        written_(other.written_),
        newest_(other.newest_) {}
  SpoolFile& operator=(const SpoolFile&) = delete;

  void append(const void* data, std::size_t size);
  std::size_t size() const { return written_ + newest_.size(); }
  // How many of them are on disk.
  std::size_t written() const { return written_; }
  // Throws Error where the disk does not give back what it took.
  void read(std::size_t begin, void* to, std::size_t size) const;

 private:
  struct File {
    explicit File(int opened) : descriptor(opened) {}
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    const int descriptor;
  };

  void flush();

  const std::filesystem::path folder_;
  std::shared_ptr<const File> file_;
  bool is_refused_ = false;  // no file, a full disk, or a copy: all else stays in memory
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
  Spool(const Spool& other) : bytes_(std::make_unique<SpoolFile>(*other.bytes_)) {}
  Spool& operator=(const Spool&) = delete;
  Spool(Spool&&) = default;
  Spool& operator=(Spool&&) = default;

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
