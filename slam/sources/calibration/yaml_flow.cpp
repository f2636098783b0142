#include "slam/sources/calibration/yaml_flow.h"

#include <algorithm>

#include "nn/base/error.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

constexpr int kDeepestFlow = 8;  // maps in maps

// Calls `take` with every character that is in no quotes, and its place.
template <typename Take>
void for_unquoted(std::string_view text, const Take& take) {
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else {
      take(c, i);
    }
  }
}

int step_of(char c) { return c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0; }

// The numbers of a list, or of a list of lists.
std::string list_text(std::string_view text, std::string_view place) {
  int depth = 0;
  bool has_values = false, has_rows = false;
  std::string numbers;
  for (const char& c : text) {
    if (c == '{' || c == '}') throw InputError(place, "a list of numbers", "a map in a list");
    depth += step_of(c);
    if (depth > 2) throw InputError(place, "a list of numbers, or of rows of them", "a list in a row");
    if (depth == 0 && &c != &text.back()) throw InputError(place, "one list", in_quotes(text));
    has_rows = has_rows || depth == 2;
    const bool is_value = step_of(c) == 0 && c != ',' && kYamlBlank.find(c) == std::string_view::npos;
    has_values = has_values || (depth == 1 && is_value);
    numbers += is_value ? c : ' ';
  }
  if (has_values && has_rows) throw InputError(place, "a list of numbers", "a list in a list");
  return numbers;
}

// What stands between the commas of a map's inside.
std::vector<std::string_view> entries_of(std::string_view inside) {
  std::vector<std::string_view> entries;
  std::size_t start = 0;
  int depth = 0;
  for_unquoted(inside, [&](char c, std::size_t i) {
    depth += step_of(c);
    if (c != ',' || depth > 0) return;
    entries.push_back(inside.substr(start, i - start));
    start = i + 1;
  });
  if (!trimmed_word(inside.substr(start)).empty()) entries.push_back(inside.substr(start));
  return entries;
}

class FlowReader {
 public:
  FlowReader(std::string_view all, std::string_view place) : all_(all), place_(place) {}

  void read(std::string_view text, const std::string& key, int depth) {
    if (text.back() != (text.front() == '[' ? ']' : '}'))
      throw InputError(place_, "brackets that close as they open", in_quotes(text));
    if (text.front() == '[') {
      values.push_back({key, line_of(text), list_text(text, place_), true});
      return;
    }
    if (depth > kDeepestFlow)
      throw InputError(place_, fmt::format("maps at most {} levels deep", kDeepestFlow), "more");
    const std::vector<std::string_view> entries = entries_of(text.substr(1, text.size() - 2));
    if (entries.empty()) values.push_back({key, line_of(text), {}, false});
    for (const std::string_view entry : entries) {
      const std::size_t colon = colon_of(entry);
      const std::string_view name = without_quotes(trimmed_word(entry.substr(0, colon)));
      if (colon == std::string_view::npos || name.empty() || name.find('.') != std::string_view::npos ||
          !is_utf8(name)) {
        throw InputError(place_, "{key: value, ...}", in_quotes(trimmed_word(entry)));
      }
      const std::string inner = key.empty() ? std::string(name) : key + "." + std::string(name);
      const std::string_view value = trimmed_word(entry.substr(colon + 1));
      if (!value.empty() && (value.front() == '[' || value.front() == '{')) {
        read(value, inner, depth + 1);
      } else {
        values.push_back({inner, line_of(trimmed_word(entry)), std::string(without_quotes(value)), false});
      }
    }
  }

  std::vector<FlowValue> values;

 private:
  // The colon after a key: one with a blank behind it, or after a quoted key.
  static std::size_t colon_of(std::string_view entry) {
    std::size_t found = std::string_view::npos;
    for_unquoted(entry, [&](char c, std::size_t i) {
      if (found != std::string_view::npos || c != ':') return;
      const bool is_quoted = i > 0 && (entry[i - 1] == '"' || entry[i - 1] == '\'');
      if (is_quoted || i + 1 == entry.size() || kYamlBlank.find(entry[i + 1]) != std::string_view::npos)
        found = i;
    });
    return found;
  }
  int line_of(std::string_view part) const {
    return static_cast<int>(std::count(all_.data(), part.data(), '\n'));
  }

  std::string_view all_, place_;
};

}  // namespace

int open_brackets(std::string_view text, int depth) {
  for_unquoted(text, [&](char c, std::size_t) { depth += step_of(c); });
  return depth;
}

std::vector<FlowValue> parse_flow(std::string_view text, std::string_view place) {
  FlowReader reader(text, place);
  reader.read(text, {}, 1);
  return std::move(reader.values);
}

}  // namespace penumbra::slam
