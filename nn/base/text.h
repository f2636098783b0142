// Text that comes from outside: is it UTF-8, its small letters, and how it can be shown without harm to a
// terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace penumbra {

// True for well-formed UTF-8: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text);

// A to Z as a to z; all else, also other letters, stays.
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
std::string lower_case(std::string_view text);

// `text` as HTML and SVG have it, also within quotes: & < > " as &amp; &lt; &gt; &quot;. What markup cannot
// hold is replaced: control characters but tabs and line ends by blanks, and in text that is not UTF-8 every
// byte above 127 by '?'.
std::string as_markup(std::string_view text);

// `text` with control characters and everything that is not UTF-8 written as \xNN, cut after about `longest`
// bytes ("..." shows the cut). For names from untrusted files in messages and tables.
std::string printable(std::string_view text, std::size_t longest = 120);

}  // namespace penumbra
