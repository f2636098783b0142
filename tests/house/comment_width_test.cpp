// Comments are as narrow as the code. clang-format leaves them alone (.clang-format, ReflowComments): where
// it breaks the line of a table it tears the table.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace penumbra {
namespace {

TEST(House, CommentsAreAsNarrowAsTheCode) {
  constexpr std::size_t kColumns = 110;  // ColumnLimit of .clang-format
  const std::filesystem::path source = PENUMBRA_SOURCE_DIR;
  int comments = 0;
  for (const char* top : {"nn", "slam", "apps", "weights_tools", "tests"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / top)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ifstream file(entry.path());
      int number = 0;
      for (std::string line; std::getline(file, line);) {
        ++number;
        const std::size_t first = line.find_first_not_of(' ');
        if (first == std::string::npos || line.compare(first, 2, "//") != 0) continue;
        ++comments;
        EXPECT_LE(line.size(), kColumns) << entry.path() << ":" << number;
      }
    }
  }
  EXPECT_GT(comments, 1000);
}

}  // namespace
}  // namespace penumbra
