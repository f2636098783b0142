#include "slam/sources/calibration/yaml_file.h"

#include <algorithm>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "slam/sources/calibration/yaml_flow.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kDeepest = 8;  // levels of keys in keys

// Up to a '#' that stands at the start or after a blank, and in no quotes.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t' || line[i - 1] == ']')) {
      return line.substr(0, i);
    }
  }
  return line;
}

std::string_view without_tag(std::string_view value) {
  if (!value.starts_with("!!")) return value;
  const std::size_t end = value.find_first_of(kYamlBlank);
  return end == std::string_view::npos ? std::string_view() : trimmed_word(value.substr(end));
}

// Lines of a text, without comments.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  bool next() {
    if (start_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', start_), text_.size());
    line_ = without_comment(text_.substr(start_, end - start_));
    start_ = end + 1;
    ++number_;
    return true;
  }
  std::string_view line() const { return line_; }
  int number() const { return number_; }

 private:
  std::string_view text_, line_;
  std::size_t start_ = 0;
  int number_ = 0;
};

// A key whose deeper keys are being read.
struct Group {
  std::size_t indent;
  std::string prefix;  // "outer."
};

}  // namespace

YamlFile::YamlFile(const std::filesystem::path& path) : path_(path.string()) {
  read(nn::read_text_file(path, "a YAML file"));
}

void YamlFile::read(std::string_view text) {
  Lines lines(text);
  std::vector<Group> groups;
  std::string last_key;         // the one that rows "- [...]" belong to
  std::size_t last_indent = 0;  // of it
  int last_line = 0;
  bool may_open = false;  // it has no value yet
  bool in_rows = false;   // its value is of rows
  const auto place = [&] { return fmt::format("{}:{}", path_, lines.number()); };
  const auto refuse = [&](std::string_view expected, std::string_view found) {
    throw InputError(place(), expected, found);
  };
  // Reads on to the bracket that closes the first one of `rest`.
  const auto read_flow = [&](std::string_view rest) {
    const int begun = lines.number();
    std::string all(rest);
    for (int depth = open_brackets(rest, 0); depth > 0; depth = open_brackets(lines.line(), depth)) {
      if (!lines.next()) {
        throw InputError(fmt::format("{}:{}", path_, begun), "a list that ends with ']', a map with '}'",
                         "no end");
      }
      all.append("\n").append(lines.line());
    }
    const std::size_t close = all.find_last_of("]}");
    if (close == std::string::npos || !trimmed_word(std::string_view(all).substr(close + 1)).empty())
      refuse("the end of the line after a list", in_quotes(trimmed_word(all.substr(close + 1))));
    std::vector<FlowValue> values =
        parse_flow(std::string_view(all).substr(0, close + 1), fmt::format("{}:{}", path_, begun));
    for (FlowValue& value : values) value.line += begun;
    return values;
  };

  // A key without a value and without keys of its own is there all the same: whoever reads it finds nothing.
  const auto leave_empty = [&] { values_[last_key] = Value{last_line, {}, false, {}}; };

  while (lines.next()) {
    const std::string_view content = trimmed_word(lines.line());
    if (content.empty() || content == "---" || content == "..." || content.front() == '%') continue;
    const std::size_t indent = lines.line().find_first_not_of(' ');
    if (lines.line()[indent] == '\t') refuse("keys indented with blanks", "a tab");
    if (content.front() == '-') {
      std::string_view row = content;  // "- - 1": the first number of a row
      while (row.starts_with("-") && (row.size() == 1 || kYamlBlank.find(row[1]) != std::string_view::npos))
        row = trimmed_word(row.substr(1));
      const bool is_number = row.find_first_not_of("0123456789+-.eE") == std::string_view::npos;
      if (last_key.empty() || row.empty() || row == content || (row.front() != '[' && !is_number))
        refuse("a key, or a row '- [...]' or '- NUMBER'", in_quotes(content));
      if (!may_open && !in_rows) refuse("a key", in_quotes(content));
      Value& rows = values_.try_emplace(last_key, Value{lines.number(), {}, true, {}}).first->second;
      may_open = false;
      in_rows = true;
      rows.text += is_number ? std::string(row) : read_flow(row).front().text;
      rows.text += ' ';
      continue;
    }
    const std::size_t colon = content.find(':');
    if (colon == std::string_view::npos ||
        (colon + 1 < content.size() && kYamlBlank.find(content[colon + 1]) == std::string_view::npos)) {
      refuse("'key: value'", in_quotes(content));
    }
    const std::string_view name = without_quotes(trimmed_word(content.substr(0, colon)));
    // "Camera.fx" is the key fx below Camera, as ORB-SLAM writes it.
    if (name.empty() || name.front() == '.' || name.back() == '.' || !is_utf8(name)) {
      refuse("a key", in_quotes(name));
    }
    // Deeper than the last key, which has no value: it holds this one.
    if (may_open && indent > last_indent) {
      groups.push_back({last_indent, last_key + "."});
      if (groups.size() > kDeepest) refuse(fmt::format("keys at most {} levels deep", kDeepest), "more");
    } else if (may_open) {
      leave_empty();
    }
    while (!groups.empty() && indent <= groups.back().indent) groups.pop_back();
    const std::string key = (groups.empty() ? std::string() : groups.back().prefix) + std::string(name);
    if (has(key)) refuse("every key once", fmt::format("{} again", in_quotes(key)));
    last_key = key;
    last_indent = indent;
    last_line = lines.number();
    in_rows = false;
    std::string_view value = without_tag(trimmed_word(content.substr(colon + 1)));
    may_open = value.empty();
    if (may_open) continue;
    if (value.front() == '[' || value.front() == '{') {
      for (FlowValue& inner : read_flow(value)) {
        const std::string name = inner.key.empty() ? key : key + "." + inner.key;
        if (has(name))
          throw InputError(fmt::format("{}:{}", path_, inner.line), "every key once",
                           fmt::format("{} again", in_quotes(name)));
        values_[name] = Value{inner.line, std::move(inner.text), inner.is_list, {}};
      }
    } else if (std::string_view("|>&*").find(value.front()) != std::string_view::npos) {
      refuse("a number, a list of numbers or a word", in_quotes(value));
    } else {
      values_[key] = Value{lines.number(), std::string(without_quotes(value)), false, {}};
    }
  }
  if (may_open) leave_empty();
}

bool YamlFile::is_group(const std::string& key) const {
  const auto after = values_.lower_bound(key + ".");
  return after != values_.end() && after->first.starts_with(key + ".");
}

std::vector<std::string> YamlFile::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : values_) keys.push_back(key);
  std::stable_sort(keys.begin(), keys.end(), [&](const std::string& a, const std::string& b) {
    return values_.at(a).line < values_.at(b).line;
  });
  return keys;
}

void YamlFile::rename(const std::string& from, const std::string& to) {
  Value value = std::move(values_.at(from));
  values_.erase(from);
  if (value.written.empty()) value.written = from;
  values_[to] = std::move(value);
}

std::string YamlFile::place(const std::string& key) const {
  const auto at = values_.find(key);
  if (at == values_.end()) return path_;
  const Value& value = at->second;
  return fmt::format("{}:{} ({})", path_, value.line, printable(value.written.empty() ? key : value.written));
}

const YamlFile::Value& YamlFile::find(const std::string& key, std::string_view expected) const {
  const auto at = values_.find(key);
  if (at == values_.end())
    throw InputError(path_, fmt::format("the key {} with {}", key, expected), "no such key");
  return at->second;
}

std::string YamlFile::text(const std::string& key) const {
  const Value& value = find(key, "a word");
  if (value.is_list) throw InputError(place(key), "a word", "a list");
  return value.text;
}

std::vector<double> YamlFile::numbers(const std::string& key) const {
  const Value& value = find(key, "numbers");
  return nn::parse_numbers(value.text, place(key));
}

std::vector<double> YamlFile::numbers(const std::string& key, std::size_t count) const {
  std::vector<double> values = numbers(key);
  if (values.size() != count) {
    throw InputError(place(key), counted(count, "number"), fmt::format("{}", values.size()));
  }
  return values;
}

double YamlFile::number(const std::string& key) const { return numbers(key, 1).front(); }

double YamlFile::number_above_zero(const std::string& key) const {
  const double value = number(key);
  if (!(value > 0.0)) throw InputError(place(key), "a number above 0", fmt::format("{:g}", value));
  return value;
}

bool YamlFile::flag(const std::string& key) const {
  const std::string value = text(key);
  // The spellings of YAML 1.1.
  for (const char* yes : {"true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON"}) {
    if (value == yes) return true;
  }
  for (const char* no : {"false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF"}) {
    if (value == no) return false;
  }
  throw InputError(place(key), "true or false", in_quotes(value));
}

std::string YamlFile::text_or(const std::string& key, const std::string& otherwise) const {
  return values_.count(key) > 0 ? text(key) : otherwise;
}

double YamlFile::number_or(const std::string& key, double otherwise) const {
  return values_.count(key) > 0 ? number(key) : otherwise;
}

}  // namespace penumbra::slam
