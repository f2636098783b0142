#include "nn/base/json_entries.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

using nlohmann::json;

constexpr int kDeepest = 32;

// Receives the parser's events and builds a tree for one entry only.
class EntryBuilder final : public nlohmann::json_sax<json> {
 public:
  EntryBuilder(std::string file, const std::vector<std::string>& sections, const JsonEntryHandler& handler)
      : file_(std::move(file)), sections_(sections), handler_(handler) {}

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return true; }  // does not occur in text

  bool start_object(std::size_t) override {
    if (depth_ == 0 && sections_.empty()) fail(file_, "a list of entries", "an object");
    return open(json::object());
  }
  bool start_array(std::size_t) override {
    if (depth_ == 0 && !sections_.empty()) fail(file_, "an object", "a list");
    return open(json::array());
  }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (!open_.empty()) {
      json& object = *open_.back();
      if (object.contains(name)) {
        fail(place(), "every key once", fmt::format("\"{}\" twice", printable(name)));
      }
      value_ = &object[name];
    } else if (depth_ == 1) {
      section_ = name;
      index_ = 0;
      in_list_ = false;
      is_wanted_ = std::find(sections_.begin(), sections_.end(), name) != sections_.end();
      if (is_wanted_ && !seen_.insert(name).second) {
        fail(file_, "every section once", fmt::format("\"{}\" twice", printable(name)));
      }
    }
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::json::exception& error) override {
    const std::string said = error.what();
    const bool is_no_number =
        said.find("'N'") != said.npos || said.find("'I'") != said.npos || said.find("'-I'") != said.npos;
    fail(fmt::format("{}, byte {}", place(), position), "well-formed JSON",
         is_no_number ? "NaN or Infinity, which Python writes and JSON does not have" : printable(said, 200));
  }

  void check_sections() const {
    for (const std::string& section : sections_) {
      if (!seen_.contains(section)) fail(file_, fmt::format("a list \"{}\"", section), "none");
    }
  }

 private:
  [[noreturn]] static void fail(const std::string& place, std::string_view expected, std::string_view found) {
    throw InputError(place, expected, found);
  }

  std::string place() const {
    if (in_list_) return JsonEntry{entry_, file_, section_, index_}.place();
    return section_.empty() ? file_ : fmt::format("{}: {}", file_, printable(section_));
  }

  // Depth of the containers around an entry.
  int entry_depth() const { return sections_.empty() ? 1 : 2; }

  // A value that is no container.
  template <class Value>
  bool add(Value&& value) {
    if (depth_ == 0) {
      fail(file_, sections_.empty() ? "a list of entries" : "an object",
           describe(json(std::forward<Value>(value))));
    }
    if (!open_.empty()) {
      place_in_open(json(std::forward<Value>(value)));
    } else if (in_list_ && depth_ == entry_depth()) {
      entry_ = json(std::forward<Value>(value));
      hand_over();
    } else if (is_wanted_ && depth_ == 1) {
      fail(place(), "a list", describe(json(std::forward<Value>(value))));
    }
    return true;
  }

  // Puts a value where the entry's tree grows and returns its place.
  json* place_in_open(json&& value) {
    if (open_.back()->is_array()) {
      open_.back()->push_back(std::move(value));
      return &open_.back()->back();
    }
    *value_ = std::move(value);
    return value_;
  }

  bool open(json&& container) {
    if (++depth_ > kDeepest) {
      fail(place(), fmt::format("nesting of at most {} levels", kDeepest), "more");
    }
    if (!open_.empty()) {
      open_.push_back(place_in_open(std::move(container)));
    } else if (in_list_ && depth_ == entry_depth() + 1) {
      entry_ = std::move(container);
      open_.push_back(&entry_);
    } else if (depth_ == entry_depth() && (sections_.empty() || is_wanted_)) {
      if (!container.is_array()) fail(place(), "a list", "an object");
      in_list_ = true;
    }
    return true;
  }

  bool close() {
    --depth_;
    if (!open_.empty()) {
      open_.pop_back();
      if (open_.empty()) hand_over();
    } else if (depth_ < entry_depth()) {
      in_list_ = false;
    }
    return true;
  }

  void hand_over() {
    handler_({entry_, file_, section_, index_});
    ++index_;
  }

  std::string file_;
  const std::vector<std::string>& sections_;
  const JsonEntryHandler& handler_;
  std::set<std::string> seen_;
  std::string section_;
  bool is_wanted_ = false, in_list_ = false;
  int depth_ = 0;
  std::size_t index_ = 0;
  json entry_;
  std::vector<json*> open_;  // the containers of entry_ that are not complete, outermost first
  json* value_ = nullptr;    // where the value of the last key goes
};

}  // namespace

std::string JsonEntry::place() const {
  return section.empty() ? fmt::format("{}: entry {}", file, index)
                         : fmt::format("{}: {}, entry {}", file, section, index);
}

void for_each_json_entry(const std::filesystem::path& path, const std::vector<std::string>& sections,
                         const JsonEntryHandler& handler) {
  const std::string text = read_text_file(path, "a JSON file");
  const std::string file = path.string();
  // The parser takes a zero byte for the end of its input and would ignore what follows.
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos) {
    throw InputError(fmt::format("{}, byte {}", file, zero), "well-formed JSON", "a zero byte");
  }
  EntryBuilder builder(file, sections, handler);
  json::sax_parse(text.begin(), text.end(), &builder);
  builder.check_sections();
}

JsonFields::JsonFields(const JsonEntry& entry) : entry_(entry) {
  if (!entry.value.is_object()) throw InputError(entry.place(), "an object", describe(entry.value));
}

bool JsonFields::has(const char* key) const {
  const auto found = entry_.value.find(key);
  return found != entry_.value.end() && !found->is_null();
}

const json& JsonFields::at(const char* key) const {
  const auto found = entry_.value.find(key);
  if (found == entry_.value.end()) {
    throw InputError(entry_.place(), fmt::format("a key \"{}\"", key), "none");
  }
  return *found;
}

std::int64_t JsonFields::integer(const char* key) const {
  const json& value = at(key);
  const std::optional<std::int64_t> number = whole_number(value);
  if (!number)
    fail(key, value.is_number_unsigned() ? "a whole number below 2^63" : "a whole number", describe(value));
  return *number;
}

double JsonFields::number(const char* key) const {
  const json& value = at(key);
  if (!value.is_number()) fail(key, "a number", describe(value));
  return value.get<double>();
}

std::string JsonFields::text(const char* key) const {
  const json& value = at(key);
  if (!value.is_string()) fail(key, "a text", describe(value));
  return value.get<std::string>();
}

void JsonFields::fail(const char* key, std::string_view expected, std::string_view found) const {
  throw InputError(place(key), expected, found);
}

std::string JsonFields::place(const char* key) const { return fmt::format("{}, {}", entry_.place(), key); }

std::optional<std::int64_t> whole_number(const json& value) {
  constexpr double kLargestExact = 0x1p53;
  if (value.is_number_float()) {
    const auto number = value.get<double>();
    if (number != std::floor(number) || std::abs(number) > kLargestExact) return std::nullopt;
    return static_cast<std::int64_t>(number);
  }
  if (value.is_number_unsigned()) {
    const auto number = value.get<std::uint64_t>();
    if (number > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return std::nullopt;
    return static_cast<std::int64_t>(number);
  }
  if (value.is_number_integer()) return value.get<std::int64_t>();
  return std::nullopt;
}

std::string describe(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return fmt::format("a list of {}", value.size());
    case json::value_t::string:
      return fmt::format("\"{}\"", printable(value.get_ref<const std::string&>()));
    case json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    default:
      return "the number " + value.dump();
  }
}

}  // namespace penumbra::nn
