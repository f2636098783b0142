// The include graph against arrows.txt: dependencies point downwards only, and there is no cycle.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace penumbra {
namespace {

const std::filesystem::path kSource = PENUMBRA_SOURCE_DIR;

using Arrows = std::map<std::string, std::set<std::string>>;  // folder -> folders that it includes

struct House {
  std::vector<std::string> order;  // folders, from the ground up
  Arrows allowed;
};

House read_house() {
  House house;
  std::ifstream file(kSource / "tests/house/arrows.txt");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with('#') || colon == std::string::npos) continue;
    const std::string folder = line.substr(0, colon);
    house.order.push_back(folder);
    std::istringstream words(line.substr(colon + 1));
    for (std::string word; words >> word;) house.allowed[folder].insert(word);
  }
  return house;
}

std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

// `files` gets one example of each arrow, for the message.
Arrows read_includes(std::map<std::string, std::string>& files) {
  Arrows found;
  for (const char* top : {"nn", "slam", "apps", "weights_tools"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kSource / top)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      const std::string name = std::filesystem::relative(entry.path(), kSource).generic_string();
      const std::string from = folder_of(name);
      found[from];
      std::ifstream source(entry.path());
      for (std::string line; std::getline(source, line);) {
        constexpr std::string_view kInclude = "#include \"";
        if (!line.starts_with(kInclude)) continue;
        std::string to = folder_of(line.substr(kInclude.size(), line.rfind('"') - kInclude.size()));
        if (to == "penumbra") to = "apps/library/penumbra";  // as other programs include it
        if (to == from) continue;
        found[from].insert(to);
        files.emplace(from + " -> " + to, name);
      }
    }
  }
  return found;
}

TEST(House, FoldersIncludeOnlyWhatArrowsAllow) {
  const House house = read_house();
  std::map<std::string, std::string> files;
  const Arrows found = read_includes(files);
  ASSERT_GT(house.order.size(), 20U);
  for (const auto& [from, targets] : found) {
    const auto known = std::find(house.order.begin(), house.order.end(), from);
    EXPECT_NE(known, house.order.end()) << from << " has no line in arrows.txt";
    if (known == house.order.end()) continue;
    const auto line = house.allowed.find(from);
    for (const std::string& to : targets) {
      EXPECT_TRUE(line != house.allowed.end() && line->second.contains(to))
          << files.at(from + " -> " + to) << ": " << from << " may not include " << to;
    }
  }
}

TEST(House, ArrowsPointDownAndEachIsNeeded) {
  const House house = read_house();
  std::map<std::string, std::string> files;
  const Arrows found = read_includes(files);
  std::set<std::string> below;
  for (const std::string& from : house.order) {
    EXPECT_TRUE(found.contains(from)) << from << " is no folder with sources";
    const auto line = house.allowed.find(from);
    if (line != house.allowed.end()) {
      for (const std::string& to : line->second) {
        EXPECT_TRUE(below.contains(to)) << from << " -> " << to << " does not point down";
        EXPECT_TRUE(found.contains(from) && found.at(from).contains(to))
            << from << " -> " << to << " is allowed, but nothing needs it";
      }
    }
    below.insert(from);
  }
}

}  // namespace
}  // namespace penumbra
