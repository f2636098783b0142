#include "nn/base/text.h"

#include <fmt/format.h>

#include <cstdint>

namespace penumbra {

namespace {

// Length in bytes of the well-formed UTF-8 character that starts at text[begin], 0 where there is none.
std::size_t character_length(std::string_view text, std::size_t begin) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[begin + i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || begin + length > text.size()) return 0;
  std::uint32_t code = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = (code << 6) | (byte(i) & 0x3FU);
  }
  const std::uint32_t smallest = length == 4 ? 0x10000 : length == 3 ? 0x800 : 0x80;
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < smallest || code > 0x10FFFF || surrogate ? 0 : length;
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = lower_case(c);
  return lower;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

std::string as_markup(std::string_view text) {
  const bool is_text = is_utf8(text);
  std::string markup;
  for (const char letter : text) {
    const char c = !is_text && static_cast<unsigned char>(letter) >= 0x80 ? '?' : letter;
    switch (c) {
      case '&':
        markup += "&amp;";
        break;
      case '<':
        markup += "&lt;";
        break;
      case '>':
        markup += "&gt;";
        break;
      case '"':
        markup += "&quot;";
        break;
      case '\t':
      case '\n':
        markup += c;
        break;
      default:
        markup += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return markup;
}

std::string printable(std::string_view text, std::size_t longest) {
  std::string shown;
  for (std::size_t i = 0; i < text.size();) {
    if (i >= longest) return shown + "...";
    const std::size_t length = character_length(text, i);
    const auto byte = static_cast<std::uint8_t>(text[i]);
    // U+0080..U+009F, the second set of control characters, are C2 80 .. C2 9F.
    const bool c1_control = length == 2 && byte == 0xC2 && static_cast<std::uint8_t>(text[i + 1]) < 0xA0;
    if (length == 0 || byte < 0x20 || byte == 0x7F || c1_control) {
      shown += fmt::format("\\x{:02x}", byte);
      ++i;
    } else {
      shown.append(text.substr(i, length));
      i += length;
    }
  }
  return shown;
}

}  // namespace penumbra
