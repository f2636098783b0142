// YAML's values in brackets: [1, 2], [[1, 2], [3, 4]] and {fx: 1, size: [2, 3]}, on one line or several.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

struct FlowValue {
  std::string key;       // below the key that holds it, "outer.inner"; empty for a list by itself
  int line = 0;          // after the first
  std::string text;      // a word, or numbers with blanks between them
  bool is_list = false;  // rows of a list of lists are joined
};

// How many brackets are open after `text`, which begins where `depth` are; quoted ones do not count.
int open_brackets(std::string_view text, int depth);

// `text` begins with a bracket and ends with the one that closes it. Throws InputError naming `place` for
// maps in lists, numbers beside lists, keys without a value.
std::vector<FlowValue> parse_flow(std::string_view text, std::string_view place);

}  // namespace penumbra::slam
