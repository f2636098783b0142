#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/safetensors.h"

namespace penumbra::nn {

namespace {

using Named = std::pair<const std::string, StoredTensor>;

// A file under a temporary name beside its final one; it takes the final name at commit(), and vanishes where
// that is not reached.
class FileInTheMaking {
 public:
  explicit FileInTheMaking(const std::filesystem::path& path) : path_(path), temporary_(path) {
    temporary_ += fmt::format(".{}.tmp", ::getpid());
    file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ < 0) fail();
  }
  ~FileInTheMaking() {
    if (file_ >= 0) ::close(file_);
    if (!committed_) ::unlink(temporary_.c_str());
  }
  FileInTheMaking(const FileInTheMaking&) = delete;
  FileInTheMaking& operator=(const FileInTheMaking&) = delete;

  void write(const void* data, std::size_t size) {
    const char* next = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t written = ::write(file_, next, std::min(size, kLargestWrite));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail();
      next += written;
      size -= static_cast<std::size_t>(written);
    }
  }

  void commit() {
    if (::fsync(file_) != 0) fail();  // the name must not reach the disk before the bytes
    const int file = std::exchange(file_, -1);
    if (::close(file) != 0) fail();
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail();
    committed_ = true;
  }

 private:
  static constexpr std::size_t kLargestWrite = std::size_t{1} << 30;  // Linux writes at most 2 GiB at once

  [[noreturn]] void fail() const {
    const int error = errno;
    throw Error(
        fmt::format("{}: cannot be written: {}", path_.string(), std::generic_category().message(error)));
  }

  std::filesystem::path path_, temporary_;
  int file_ = -1;
  bool committed_ = false;
};

void check(const StateDict& state, const std::string& place) {
  for (const auto& [key, value] : state.metadata) {
    if (!is_utf8(key) || !is_utf8(value)) {
      throw InputError(place + ": metadata", "UTF-8", printable(key) + "=" + printable(value));
    }
  }
  for (const auto& [name, tensor] : state.tensors) {
    const std::string where = fmt::format("{}: \"{}\"", place, printable(name));
    if (name == "__metadata__") throw InputError(where, "another name", "the one that the format reserves");
    if (!is_utf8(name)) throw InputError(where, "a name in UTF-8", "other bytes");
    const auto size = bytes_of(tensor.type, static_cast<std::uint64_t>(tensor.elements()));
    if (size != tensor.bytes.size()) {
      throw InputError(where, fmt::format("{} bytes", size.value_or(0)),
                       fmt::format("{}", tensor.bytes.size()));
    }
  }
}

}  // namespace

void write_safetensors(const std::filesystem::path& path, const StateDict& state) {
  check(state, path.string());
  // Sizes are multiples of the element size, so with larger elements first every offset is aligned.
  std::vector<const Named*> order;
  for (const Named& named : state.tensors) order.push_back(&named);
  std::stable_sort(order.begin(), order.end(), [](const Named* a, const Named* b) {
    return size_of(a->second.type) > size_of(b->second.type);
  });

  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  if (!state.metadata.empty()) header["__metadata__"] = state.metadata;
  std::size_t offset = 0;
  // nlohmann's ordered object finds a key in linear time: append entries, the names are known to differ.
  auto& entries = header.get_ref<nlohmann::ordered_json::object_t&>();
  for (const Named* named : order) {
    const auto& [name, tensor] = *named;
    const std::size_t end = offset + tensor.bytes.size();
    nlohmann::ordered_json entry = {
        {"dtype", to_string(tensor.type)}, {"shape", tensor.shape}, {"data_offsets", {offset, end}}};
    entries.push_back({name, std::move(entry)});
    offset = end;
  }
  std::string json = header.dump();
  json.resize((json.size() + 7) / 8 * 8, ' ');
  if (json.size() > kLongestSafetensorsHeader) {
    throw Error(fmt::format("{}: cannot be written: its header would have {} bytes, at most {} are readable",
                            path.string(), json.size(), kLongestSafetensorsHeader));
  }

  FileInTheMaking file(path);
  const std::uint64_t header_size = json.size();
  file.write(&header_size, sizeof(header_size));
  file.write(json.data(), json.size());
  for (const Named* named : order) file.write(named->second.bytes.data(), named->second.bytes.size());
  file.commit();
}

}  // namespace penumbra::nn
