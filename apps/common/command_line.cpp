#include "apps/common/command_line.h"

#include <string_view>

#include "nn/base/text.h"

namespace penumbra::apps {

const char* const kVersion = PENUMBRA_VERSION;

namespace {

std::string remembered_line;

}  // namespace

std::string in_shell_quotes(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == word.npos) return std::string(word);
  std::string quoted(1, '\'');
  for (const char c : word) {
    if (c == '\'') quoted += "'\\'";
    quoted += c;
  }
  quoted += '\'';
  return quoted;
}

void remember_command_line(int argc, const char* const* argv) {
  constexpr std::size_t kLongestWord = 4096;
  remembered_line = "penumbra";
  for (int i = 1; i < argc; ++i) {
    remembered_line += ' ';
    remembered_line += printable(in_shell_quotes(argv[i]), kLongestWord);
  }
}

const std::string& command_line() { return remembered_line; }

}  // namespace penumbra::apps
