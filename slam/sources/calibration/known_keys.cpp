#include "slam/sources/calibration/known_keys.h"

#include <algorithm>
#include <map>

#include "nn/base/error.h"
#include "nn/base/nearest_word.h"
#include "nn/base/text.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

// What describes a matrix beside its "data"; the numbers themselves are counted where they are used.
bool is_matrix_header(const std::vector<std::string>& keys, std::string_view key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string_view::npos) return false;
  const std::string_view leaf = key.substr(dot + 1);
  return (leaf == "rows" || leaf == "cols" || leaf == "dt") &&
         std::find(keys.begin(), keys.end(), std::string(key.substr(0, dot)) + ".data") != keys.end();
}

std::string_view without_data(std::string_view key) {
  return key.ends_with(".data") ? key.substr(0, key.size() - 5) : key;
}

}  // namespace

void use_known_keys(YamlFile& yaml, std::span<const KnownKey> known) {
  std::map<std::string, const KnownKey*> by_spelling;
  std::vector<std::string_view> names;  // the known name first: of equally near ones it is suggested
  for (const KnownKey& key : known) {
    by_spelling[plain_word(key.name)] = &key;
    names.push_back(key.name);
  }
  for (const KnownKey& key : known) {
    for (const std::string_view spelling : key.spellings) {
      by_spelling[plain_word(spelling)] = &key;
      names.push_back(spelling);
    }
  }
  const std::vector<std::string> keys = yaml.keys();
  for (const std::string& key : keys) {
    if (is_matrix_header(keys, key)) continue;
    const auto at = by_spelling.find(plain_word(without_data(key)));
    if (at == by_spelling.end()) {
      throw InputError(yaml.place(key), "a key that is known" + suggestion(without_data(key), names),
                       fmt::format("'{}'", printable(key, 60)));
    }
    const std::string& name = at->second->name;
    if (name == key) continue;
    if (yaml.has_value(name)) {
      throw InputError(yaml.place(key), fmt::format("one of two keys for {}", name),
                       fmt::format("'{}' beside {}", printable(key, 60), yaml.place(name)));
    }
    yaml.rename(key, name);
  }
}

}  // namespace penumbra::slam
