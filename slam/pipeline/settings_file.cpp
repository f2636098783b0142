#include "slam/pipeline/settings_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/nearest_word.h"
#include "nn/base/text.h"
#include "slam/pipeline/setting_fields.h"

namespace penumbra::slam {

namespace {

using Json = nlohmann::json;

constexpr std::string_view kExpected = "settings as JSON, as penumbra slam --print-settings prints them";

Json parse(const std::string& text, const std::string& place) {
  std::vector<std::set<std::string>> names;  // of the objects that are open
  const auto note = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key && !names.back().insert(value.get<std::string>()).second) {
      throw InputError(place, "every setting once", fmt::format("two of \"{}\"", value.get<std::string>()));
    }
    return true;
  };
  try {
    return Json::parse(text, note, /*allow_exceptions=*/true, /*ignore_comments=*/true);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw InputError(fmt::format("{}:{}", place, 1 + std::count(text.begin(), end, '\n')), kExpected,
                     printable(error.what()));
  } catch (const Json::exception& error) {  // a number that no double holds
    throw InputError(place, kExpected, printable(error.what()));
  }
}

template <class Mode>
void read_word(const Json& json, const std::string& place, Mode& mode) {
  const std::string found = json.is_string() ? json.get<std::string>() : json.dump();
  std::vector<std::string_view> words;
  for (const auto& [word, value] : kWords<Mode>) {
    words.push_back(word);
    if (json.is_string() && word == found) {
      mode = value;
      return;
    }
  }
  throw InputError(place, fmt::format("one of {}", fmt::join(words, ", ")), printable(found));
}

void read_value(const Json& json, const std::string& place, const SettingField& field) {
  const auto expected = [&](const char* what) {
    return InputError(place, fmt::format("{}{}{}", what, *field.unit ? ", " : "", field.unit),
                      printable(json.dump()));
  };
  std::visit(
      [&](auto* value) {
        using Value = std::remove_pointer_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, bool>) {
          if (!json.is_boolean()) throw expected("true or false");
          *value = json.get<bool>();
        } else if constexpr (std::is_same_v<Value, int>) {
          const double number = json.is_number() ? json.get<double>() : 0.5;
          if (number != std::floor(number) || std::abs(number) > 1e9) throw expected("a whole number");
          *value = static_cast<int>(number);
        } else if constexpr (std::is_floating_point_v<Value>) {
          if (!json.is_number()) throw expected("a number");
          *value = json.get<Value>();
        } else {
          read_word(json, place, *value);
        }
      },
      field.value);
}

class SettingsReader {
 public:
  SettingsReader(std::string file, SlamSettings& settings)
      : file_(std::move(file)), fields_(setting_fields(settings)) {}

  void read(const Json& json, const std::string& prefix) {
    const std::string place = prefix.empty() ? file_ : fmt::format("{}, {}", file_, prefix);
    if (!json.is_object()) throw InputError(place, "an object of settings", printable(json.dump()));
    for (const auto& [key, value] : json.items()) {
      const std::string name = prefix.empty() ? key : fmt::format("{}.{}", prefix, key);
      const auto field =
          std::find_if(fields_.begin(), fields_.end(), [&](const SettingField& f) { return f.name == name; });
      const bool is_path = key.find('.') != std::string::npos;  // groups are objects
      if (field != fields_.end() && !is_path) {
        read_value(value, fmt::format("{}, {}", file_, name), *field);
      } else if (is_group(name) && !is_path) {
        read(value, name);
      } else {
        throw InputError(place, "settings by their names",
                         fmt::format("\"{}\"{}", printable(key), meant(name)));
      }
    }
  }

 private:
  bool is_group(const std::string& name) const {
    return std::any_of(fields_.begin(), fields_.end(),
                       [&](const SettingField& f) { return f.name.starts_with(name + "."); });
  }
  std::string meant(const std::string& name) const {
    std::vector<std::string_view> names;
    for (const SettingField& field : fields_) names.push_back(field.name);
    return suggestion(name, names);
  }

  std::string file_;
  std::vector<SettingField> fields_;
};

std::string value_text(const SettingField& field) {
  return std::visit(
      [](const auto* value) -> std::string {
        using Value = std::remove_cvref_t<decltype(*value)>;
        if constexpr (std::is_enum_v<Value>) {
          return Json(word_of(*value)).dump();
        } else if constexpr (std::is_same_v<Value, bool>) {
          return *value ? "true" : "false";
        } else {
          return fmt::format("{}", *value);
        }
      },
      field.value);
}

}  // namespace

void read_settings(const std::filesystem::path& path, SlamSettings& settings) {
  const std::string text = nn::read_text_file(path, "settings as JSON");
  SlamSettings read = settings;
  SettingsReader(path.string(), read).read(parse(text, path.string()), "");
  check_settings(read, path.string());
  settings = read;
}

std::string settings_text(const SlamSettings& settings) {
  SlamSettings copy = settings;  // fields point to what could be written
  const std::vector<SettingField> fields = setting_fields(copy);
  std::string text = "{";
  std::vector<std::string> open;  // groups
  bool first = true;
  const auto begin_line = [&] {
    text += first ? "\n" : ",\n";
    text.append(2 * (open.size() + 1), ' ');
    first = false;
  };
  const auto close_group = [&] {
    text += '\n';
    text.append(2 * open.size(), ' ');
    text += '}';
    open.pop_back();
    first = false;
  };
  for (const SettingField& field : fields) {
    std::vector<std::string> path;
    for (std::size_t at = 0, dot = 0; dot != std::string::npos; at = dot + 1) {
      dot = field.name.find('.', at);
      path.push_back(field.name.substr(at, dot - at));
    }
    const std::size_t groups = path.size() - 1;
    while (open.size() > groups || !std::equal(open.begin(), open.end(), path.begin())) close_group();
    while (open.size() < groups) {
      begin_line();
      text += fmt::format("\"{}\": {{", path[open.size()]);
      open.push_back(path[open.size()]);
      first = true;
    }
    begin_line();
    if (*field.unit != '\0') text += fmt::format("/* {} */ ", field.unit);
    text += fmt::format("\"{}\": {}", path.back(), value_text(field));
  }
  while (!open.empty()) close_group();
  return text + "\n}\n";
}

}  // namespace penumbra::slam
