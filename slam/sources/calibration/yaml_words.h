// Words of YAML files, and the few things that are done with all of them.
#pragma once

#include <fmt/core.h>

#include <cctype>
#include <string>
#include <string_view>

#include "nn/base/text.h"

namespace penumbra::slam {

inline constexpr std::string_view kYamlBlank = " \t\r\n";

inline std::string_view trimmed_word(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kYamlBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kYamlBlank) - first + 1);
}

inline std::string_view without_quotes(std::string_view value) {
  const bool is_quoted =
      value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front();
  return is_quoted ? value.substr(1, value.size() - 2) : value;
}

// For messages.
inline std::string in_quotes(std::string_view text) { return fmt::format("'{}'", printable(text, 40)); }

// In small letters and without '-', '_' and blanks: RGB-D, rgb_d and rgbd are one.
inline std::string plain_word(std::string_view word) {
  std::string plain;
  for (const char c : word) {
    if (c != '-' && c != '_' && c != ' ') plain += lower_case(c);
  }
  return plain;
}

}  // namespace penumbra::slam
