#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/test_data.h"

namespace penumbra {
namespace {

TEST(EvalMasksCommand, PrintsBothTablesAndDrawsTheSteps) {
  const test::TemporaryDirectory folder;
  const std::string office = (folder / "office").string();
  ASSERT_EQ(test::run_penumbra("synth --scene office --frames 2 --annotations --out " + office).exit_code, 0);
  const test::ProgramResult result =
      test::run_penumbra(fmt::format("eval-masks '{0}' --pictures '{0}/steps'", office));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"paper, k = 3", "grown, repaired", "people, cut off", "| modes |", "| adaptive |"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  EXPECT_FALSE(std::filesystem::is_empty(folder / "office/steps"));
}

TEST(EvalMasksCommand, SaysWhatIsMissing) {
  const test::TemporaryDirectory folder;
  const std::string street = (folder / "street").string();
  ASSERT_EQ(test::run_penumbra("synth --frames 2 --size 310x94 --out " + street).exit_code, 0);
  const test::ProgramResult stereo = test::run_penumbra(fmt::format("eval-masks '{}'", street));
  EXPECT_EQ(stereo.exit_code, 1);
  EXPECT_NE(stereo.err.find("RGB-D"), std::string::npos) << stereo.err;
  const std::string rgbd = (folder / "rgbd").string();
  ASSERT_EQ(test::run_penumbra("synth --sensor rgbd --frames 2 --size 310x94 --out " + rgbd).exit_code, 0);
  const test::ProgramResult unmasked =
      test::run_penumbra(fmt::format("eval-masks '{0}' --masks '{0}/nowhere'", rgbd));
  EXPECT_EQ(unmasked.exit_code, 1);
  EXPECT_NE(unmasked.err.find("nowhere: expected a folder"), std::string::npos) << unmasked.err;
}

}  // namespace
}  // namespace penumbra
