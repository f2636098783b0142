// The part of YAML that calibration files use: nested keys with numbers, lists of numbers and words.
//
//   %YAML:1.0                         directives, "---" and comments are skipped
//   T_BS:                             a key that holds keys: "T_BS.data" names the list below
//     cols: 4
//     data: [0.0, 1.0,                a list may go on over several lines
//            0.5, 0.0]                rows in it, [[0.0, 1.0], [0.5, 0.0]], are joined to one list; so are
//                                     "- [0.0, 1.0]", "- 0.5" and "- - 0.5", one a line
//   left: {fx: 458.6, fy: 457.3}      "left.fx" and "left.fy", as if they stood below it (yaml_flow.h)
//   Camera.fx: 458.6                  as if fx stood below Camera
//   camera_model: pinhole             a word, quoted or not
//
// Anchors, block texts, lists of words and several documents are refused, as are tabs before a key and keys
// that stand twice. OpenCV's tags (!!opencv-matrix) are skipped.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

class YamlFile {
 public:
  // Throws InputError (file:line) where the file cannot be read as said above.
  explicit YamlFile(const std::filesystem::path& path);

  bool has(const std::string& key) const { return values_.count(key) > 0 || is_group(key); }
  bool has_value(const std::string& key) const { return values_.count(key) > 0; }
  // All keys with a value, in the order of the file's lines.
  std::vector<std::string> keys() const;
  // From now on the value of `from`, which must be there, is that of `to`; place() still says what is
  // written.
  void rename(const std::string& from, const std::string& to);
  // Throw InputError (file:line) where the key is missing or holds something else.
  std::string text(const std::string& key) const;
  double number(const std::string& key) const;
  double number_above_zero(const std::string& key) const;
  std::vector<double> numbers(const std::string& key) const;
  std::vector<double> numbers(const std::string& key, std::size_t count) const;
  bool flag(const std::string& key) const;  // true or false, yes or no, on or off
  // The same with a value for a key that is missing.
  std::string text_or(const std::string& key, const std::string& otherwise) const;
  double number_or(const std::string& key, double otherwise) const;

  // "file:line" of a key, or the file where it is missing.
  std::string place(const std::string& key) const;

 private:
  struct Value {
    int line = 0;
    std::string text;      // as in the file, without brackets, quotes and comment
    bool is_list = false;  // [...] or rows of them
    std::string written;   // the key as in the file, where it was renamed
  };
  void read(std::string_view text);
  bool is_group(const std::string& key) const;
  const Value& find(const std::string& key, std::string_view expected) const;

  std::string path_;
  std::map<std::string, Value> values_;  // by key, "outer.inner"
};

}  // namespace penumbra::slam
