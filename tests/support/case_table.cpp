#include "tests/support/case_table.h"

#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>

#include "nn/base/error.h"
#include "tests/support/test_data.h"

namespace penumbra::test {

namespace {

namespace fs = std::filesystem;

void check_complete(const Case& c, std::set<std::string>& names) {
  const auto refuse = [&](const char* expected, const std::string& found) {
    throw InputError(c.place, expected, found);
  };
  constexpr const char* kNameCharacters = "abcdefghijklmnopqrstuvwxyz0123456789_";
  if (c.name.empty() || c.name.find_first_not_of(kNameCharacters) != std::string::npos)
    refuse("a name of a-z, 0-9 and _", fmt::format("'{}'", c.name));
  if (!names.insert(c.name).second) refuse("a name that is new", c.name);
  if (c.why.empty() || c.run.empty()) refuse("why: and run:", "neither or one of them");
  if (!c.needs.empty() && c.needs != "data" && c.needs != "cases") refuse("data or cases", c.needs);
}

void set(Case& c, std::string_view key, const std::string& value, const std::string& place) {
  if (key == "case") {
    c.name = value;
  } else if (key == "why") {
    c.why = value;
  } else if (key == "needs") {
    c.needs = value;
  } else if (key == "make") {
    c.make.push_back(value);
  } else if (key == "run") {
    c.run.push_back(value);
  } else if (key == "says") {
    c.says.push_back(value);
  } else if (key == "not") {
    c.says_not.push_back(value);
  } else if (key == "exit") {
    const char* const end = value.data() + value.size();
    if (std::from_chars(value.data(), end, c.exit_code).ptr != end)
      throw InputError(place, "an exit code", value);
  } else {
    throw InputError(place, "case, why, make, run, exit, says, not or needs", std::string(key));
  }
}

std::vector<Case> read_table(const fs::path& path) {
  std::vector<Case> cases;
  std::set<std::string> names;
  std::ifstream file(path);
  bool open = false;
  int number = 0;
  const auto close = [&] {
    if (open) check_complete(cases.back(), names);
    open = false;
  };
  for (std::string line; std::getline(file, line);) {
    ++number;
    const std::string place = fmt::format("{}:{}", path.filename().string(), number);
    if (line.empty()) close();
    if (line.empty() || line.front() == '#') continue;
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) throw InputError(place, "'key: value'", line);
    if (!open) {
      cases.emplace_back();
      cases.back().kind = path.stem().string();
      cases.back().place = place;
      open = true;
    }
    set(cases.back(), std::string_view(line).substr(0, colon), line.substr(colon + 2), place);
  }
  close();
  return cases;
}

}  // namespace

std::vector<Case> read_case_tables(const fs::path& folder) {
  std::vector<fs::path> tables;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".cases") tables.push_back(entry.path());
  }
  std::sort(tables.begin(), tables.end());
  std::vector<Case> all;
  for (const fs::path& table : tables) {
    std::vector<Case> cases = read_table(table);
    std::move(cases.begin(), cases.end(), std::back_inserter(all));
  }
  return all;
}

CaseResult run_case(const Case& c, const fs::path& folder) {
  const fs::path work = folder / "work", output = folder / "output", script = folder / "script";
  fs::create_directories(work);
  std::ofstream text(script);
  text << fmt::format(
      "set -eu\nSOURCE='{}' FIXTURES='{}' DATA='{}' CASES='{}' PENUMBRA='{}'\npenumbra() {{ \"$PENUMBRA\" "
      "\"$@\"; }}\n",
      source_path("").string(), fixture("").string(), fs::absolute(data_root()).string(),
      fs::absolute(cases_root()).string(), PENUMBRA_BINARY);
  // What prepares the case must succeed; its output is shown only where it does not.
  const std::string prepared = (folder / "prepared").string();
  for (const std::string& line : c.make)
    text << fmt::format("{{ {}\n}} >'{}' 2>&1 || {{ cat '{}'; exit 99; }}\n", line, prepared, prepared);
  text << "set +e\n";
  for (const std::string& line : c.run) text << line << '\n';
  text.close();
  const std::string command = fmt::format("cd '{}' && bash '{}' >'{}' 2>&1 </dev/null", work.string(),
                                          script.string(), output.string());
  const int status = std::system(command.c_str());
  CaseResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::ifstream file(output, std::ios::binary);
  result.text = {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return result;
}

}  // namespace penumbra::test
