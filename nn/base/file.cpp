#include "nn/base/file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "nn/base/error.h"
#include "nn/base/file_in_the_making.h"

namespace penumbra::nn {

namespace {

namespace fs = std::filesystem;

constexpr std::streamoff kLargestFile = (1L << 31) - 1;

std::string last_system_error() { return std::strerror(errno); }

// The encoding that `text` gives away by its first bytes, if it is one whose bytes are no text to us; else
// null.
const char* foreign_encoding(std::string_view text) {
  using namespace std::string_view_literals;
  if (text.starts_with("\xFF\xFE\0\0"sv) || text.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32";
  if (text.starts_with("\xFF\xFE"sv) || text.starts_with("\xFE\xFF"sv)) return "UTF-16";
  // Without a mark: texts of ours begin with ASCII, of which UTF-16 makes pairs with one zero byte.
  const bool is_pair = text.size() >= 2 && (text[0] == '\0') != (text[1] == '\0');
  return is_pair ? "UTF-16" : nullptr;
}

// "\r\n" and '\r' become '\n', in place.
void unify_line_ends(std::string& text) {
  std::size_t to = text.find('\r');
  if (to == std::string::npos) return;
  for (std::size_t from = to; from < text.size(); ++from) {
    if (text[from] == '\r') {
      if (from + 1 < text.size() && text[from + 1] == '\n') continue;
      text[to++] = '\n';
    } else {
      text[to++] = text[from];
    }
  }
  text.resize(to);
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

std::string read_text_file(const fs::path& path, std::string_view expected) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string text = read_file(path, expected);
  if (const char* encoding = foreign_encoding(text); encoding != nullptr) {
    throw InputError(path.string(), fmt::format("{}, as UTF-8 text", expected),
                     fmt::format("{} text (iconv -f {} -t UTF-8 converts it)", encoding, encoding));
  }
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  unify_line_ends(text);
  return text;
}

void write_file(const fs::path& path, std::string_view bytes, bool durable) {
  FileInTheMaking file(path);
  file.write(bytes.data(), bytes.size());
  file.commit(durable);
}

void require_writable_folder(const fs::path& folder) { FileInTheMaking(folder / ".penumbra"); }

void make_writable_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  require_writable_folder(folder);
}

}  // namespace penumbra::nn
