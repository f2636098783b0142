// The saved corpus, without a fuzzer: what was found once stays fixed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <set>
#include <vector>

#include "tests/fuzz/repair.h"
#include "tests/fuzz/target.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra::fuzz {

// How GoogleTest names a target.
void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

namespace {

namespace fs = std::filesystem;

const fs::path kCorpus = test::source_path("tests/fuzz/corpus");

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

class FuzzTarget : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzTarget, ReadsTheValidInputsOfItsCorpusAndRefusesTheBad) {
  int valid = 0, bad = 0;
  for (const fs::path& path : files_below(kCorpus / GetParam().name)) {
    SCOPED_TRACE(path);
    const std::string name = path.filename().string();
    bool is_read = false;
    ASSERT_NO_THROW(is_read = GetParam().read(test::read_file(path)));
    if (name.starts_with("valid")) {
      EXPECT_TRUE(is_read);
      ++valid;
    } else if (name.starts_with("bad")) {
      EXPECT_FALSE(is_read);
      ++bad;
    }
  }
  EXPECT_GT(valid, 0);
  EXPECT_GT(bad, 0);
}

TEST_P(FuzzTarget, ReadsOrRefusesTheInputsOfAllTargetsAndAllFixtures) {
  std::vector<fs::path> files = files_below(kCorpus);
  for (const fs::path& path : files_below(test::fixture(""))) files.push_back(path);
  for (const fs::path& path : files) {
    SCOPED_TRACE(path);
    ASSERT_NO_THROW(GetParam().read(test::read_file(path)));
  }
}

INSTANTIATE_TEST_SUITE_P(Corpus, FuzzTarget, ::testing::ValuesIn(all_targets().begin(), all_targets().end()),
                         [](const auto& info) { return info.param.name; });

TEST(FuzzCorpus, HasAFolderForEveryTargetAndStaysSmall) {
  std::set<std::string> folders, names;
  for (const fs::directory_entry& entry : fs::directory_iterator(kCorpus)) {
    folders.insert(entry.path().filename().string());
  }
  for (const Target& target : all_targets()) names.insert(target.name);
  EXPECT_EQ(folders, names);
  std::uintmax_t bytes = 0;
  for (const fs::path& path : files_below(kCorpus)) bytes += fs::file_size(path);
  EXPECT_LE(bytes, 200'000U);
}

TEST(FuzzRepair, MakesTheCheckSumsOfDamagedFilesRight) {
  const std::string png = test::read_file(kCorpus / "image_container/valid_grey.png");
  std::string damaged = png;
  damaged[29] ^= 1;  // in the CRC of the header chunk
  EXPECT_EQ(repair_png(damaged), png);

  const std::string zip = test::read_file(kCorpus / "torch_zip/valid_without_version");
  damaged = zip;
  const std::size_t entry = zip.find("PK\1\2");
  damaged[14] ^= 1;          // in the CRC of the first entry's own header
  damaged[entry + 16] ^= 1;  // and in the central directory
  EXPECT_EQ(repair_zip(damaged), zip);
}

}  // namespace
}  // namespace penumbra::fuzz
