#include "apps/fleet/manifest.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <sstream>
#include <string_view>

#include "apps/common/commands.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"
#include "slam/pipeline/settings_file.h"

namespace penumbra::apps {

namespace {

std::vector<std::string> words_of(std::string_view line, const std::string& place) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        words.back() += c;
      continue;
    }
    if (c == ' ' || c == '\t') {
      in_word = false;
      continue;
    }
    if (c == '#' && !in_word) break;
    if (!in_word) words.emplace_back();
    in_word = true;
    if (c == '"' || c == '\'')
      quote = c;
    else if (c == '\\' && i + 1 < line.size())
      words.back() += line[++i];
    else
      words.back() += c;
  }
  if (quote != 0) throw InputError(place, fmt::format("a second {}", quote), "the end of the line");
  return words;
}

void require_name(const std::string& name, const std::string& place) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  if (name.find_first_not_of(kLetters) != name.npos || name[0] == '.' || name[0] == '-')
    throw InputError(place, "a name of letters, digits, '.', '_' and '-'", printable(name));
}

// Options may name files, too: all paths are looked at from the manifest's folder.
class InFolder {
 public:
  explicit InFolder(const std::filesystem::path& folder) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder);
  }
  ~InFolder() {
    std::error_code error;
    std::filesystem::current_path(before_, error);
  }
  InFolder(const InFolder&) = delete;
  InFolder& operator=(const InFolder&) = delete;

 private:
  std::filesystem::path before_;
};

void require_existing(const std::string& path, const std::string& place, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw InputError(place, what, printable(path) + ", which is not there");
}

void require_settings(const std::string& path, const std::string& place) {
  slam::SlamSettings settings;
  try {
    slam::read_settings(path, settings);
  } catch (const InputError& error) {
    throw InputError(place, "settings that penumbra slam accepts", error.what());
  }
}

// As the command itself would say, without running it.
void require_options(const std::vector<std::string>& arguments, const std::string& place) {
  for (const char* ours :
       {"--out", "--save-map", "--load-map", "--view", "--print-settings", "--help", "-h"}) {
    for (const std::string& word : arguments) {
      if (word == ours || word.starts_with(std::string(ours) + "="))
        throw InputError(place, "options beside those that the plan gives", ours);
    }
  }
  CLI::App app;
  add_slam_command(app);
  app.get_subcommand("slam")->callback([] {});
  std::vector<std::string> words(arguments.rbegin(), arguments.rend());
  words.insert(words.begin(), {"out", "--out"});  // last first
  words.emplace_back("slam");
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw InputError(place, "options of penumbra slam", error.what());
  }
  for (const CLI::Option* option : app.get_subcommand("slam")->get_options()) {
    const std::string type = option->get_type_name();
    if (!type.starts_with("FILE") && !type.starts_with("DIR")) continue;
    for (const std::string& named : option->results()) {
      require_existing(named, place, "what " + option->get_name() + " names");
      if (option->get_name() == "--settings") require_settings(named, place);
    }
  }
}

}  // namespace

std::vector<FleetRecording> read_fleet_manifest(const std::filesystem::path& path) {
  std::istringstream text(nn::read_text_file(path, "a manifest of recordings"));
  const InFolder folder(std::filesystem::absolute(path).parent_path());
  std::vector<FleetRecording> recordings;
  std::map<std::string, int> lines;  // of names
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    const std::string place = fmt::format("{}:{}", path.string(), ++number);
    const std::vector<std::string> words = words_of(line, place);
    if (words.empty()) continue;
    if (words.size() < 3 || words[0].empty())
      throw InputError(place, "a name, a recording and a calibration (or -)", printable(line));
    const std::string& name = words[0];
    require_name(name, place);
    if (const auto [before, is_new] = lines.emplace(name, number); !is_new)
      throw InputError(place, "a name of its own", fmt::format("{}, as in line {}", name, before->second));
    require_existing(words[1], place, "a recording");
    FleetRecording recording{name, {words[1]}};
    if (words[2] != "-") {
      require_existing(words[2], place, "a calibration");
      recording.arguments.insert(recording.arguments.end(), {"--camera", words[2]});
    }
    recording.arguments.insert(recording.arguments.end(), words.begin() + 3, words.end());
    require_options(recording.arguments, place);
    recordings.push_back(std::move(recording));
  }
  if (recordings.empty()) throw InputError(path.string(), "a recording a line", "none");
  return recordings;
}

}  // namespace penumbra::apps
