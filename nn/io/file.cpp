#include "nn/io/file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

namespace fs = std::filesystem;

constexpr std::streamoff kLargestFile = (1L << 31) - 1;

std::string last_system_error() { return std::strerror(errno); }

// Unique among the threads of this process and among processes of this machine.
fs::path temporary_name(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  fs::path name = path;
  name += fmt::format(".{}.{}.part", getpid(), counter.fetch_add(1));
  return name;
}

}  // namespace

std::string read_file(const fs::path& path, std::string_view expected) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw InputError(path.string(), expected, "no such file");
  if (fs::is_directory(status)) throw InputError(path.string(), expected, "a folder");
  if (error) throw InputError(path.string(), expected, error.message());
  if (!fs::is_regular_file(status)) throw InputError(path.string(), expected, "something not a plain file");

  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw InputError(path.string(), expected, last_system_error());
  const std::streamoff size = file.tellg();
  if (size > kLargestFile) throw InputError(path.string(), expected, fmt::format("a file of {} bytes", size));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw InputError(path.string(), expected, "a file that cannot be read to its end");
  return bytes;
}

void write_file(const fs::path& path, std::string_view bytes) {
  const fs::path temporary = temporary_name(path);
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  if (!file) throw Error(fmt::format("{}: cannot be written: {}", path.string(), last_system_error()));
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code error;
  if (file.fail()) {
    error = std::make_error_code(static_cast<std::errc>(errno));
  } else {
    fs::rename(temporary, path, error);
  }
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
  }
}

}  // namespace penumbra::nn
