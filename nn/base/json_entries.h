// Reads JSON files that are long lists of entries, one entry at a time: memory is that of the file and of one
// entry, however many there are. Made for COCO's files.
//
//   [entry, entry, ...]                                          the whole file is the list
//   {"images": [entry, ...], "annotations": [entry, ...], ...}   lists in sections, in any order
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::nn {

// An entry that was just read, and where it stands. Valid during the call that hands it over.
struct JsonEntry {
  const nlohmann::json& value;
  const std::string& file;
  const std::string& section;  // empty where the whole file is the list
  std::size_t index;           // in its list, from 0

  // "FILE: SECTION, entry 17", for messages.
  std::string place() const;
};

using JsonEntryHandler = std::function<void(const JsonEntry&)>;

// Hands every entry of the lists named in `sections` to `handler`, in the order of the file; an empty
// `sections` means that the whole file is the list. Other sections are skipped.
// Throws InputError where the file cannot be read or is no well-formed JSON, where nesting is deeper than 32,
// a section or a key of an entry stands twice, a section is missing or is no list.
void for_each_json_entry(const std::filesystem::path& path, const std::vector<std::string>& sections,
                         const JsonEntryHandler& handler);

// The keys of an entry, checked as they are read: every failure is an InputError that names the entry, the
// key, what was expected and what was found.
class JsonFields {
 public:
  explicit JsonFields(const JsonEntry& entry);  // throws unless the entry is an object

  // Whether the key is there with another value than null.
  bool has(const char* key) const;
  // The value; throws where the key is missing.
  const nlohmann::json& at(const char* key) const;
  // Within 64 bits. Writers in languages with one kind of number write 3 as 3.0: it is taken.
  std::int64_t integer(const char* key) const;
  double number(const char* key) const;  // finite
  std::string text(const char* key) const;

  std::string place() const { return entry_.place(); }
  std::string place(const char* key) const;  // "FILE: SECTION, entry 17, KEY"
  [[noreturn]] void fail(const char* key, std::string_view expected, std::string_view found) const;

 private:
  const JsonEntry& entry_;
};

// The whole number that a JSON number is, 3 or 3.0; none for any other value.
std::optional<std::int64_t> whole_number(const nlohmann::json& value);

// A JSON value in words, for "found ...": "the number 3.5", "a list of 2", "\"text\"".
std::string describe(const nlohmann::json& value);

}  // namespace penumbra::nn
