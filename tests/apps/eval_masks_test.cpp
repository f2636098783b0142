#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <utility>

#include "nn/base/file.h"
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

// The two shares in the row of a mode, in per cent.
std::pair<double, double> shares_of(const std::string& mode, const std::string& out) {
  const std::size_t at = out.find("| " + mode + " | ");
  std::pair<double, double> shares = {-1.0, -1.0};
  if (at != out.npos)
    std::sscanf(out.c_str() + at + mode.size() + 4, " %lf (%*d) | %lf", &shares.first, &shares.second);
  return shares;
}

// One real frame of TUM fr3/walking_xyz: one person sits, one is cut off by the border; a third of the depth
// is missing. Its masks are 8 to 15 pixels too wide.
TEST(EvalMasksCommand, TellsPeopleFromTheOfficeInARealFrame) {
  PENUMBRA_REAL_DATA(real, "tum/fr3_walking_xyz_frame");
  const test::TemporaryDirectory root;
  const std::filesystem::path folder = root / "fr3_frame";
  const std::pair<const char*, const char*> copies[] = {
      {"rgb.png", "rgb"}, {"depth.png", "depth"}, {"mask.png", "people"}};
  for (const auto& [name, to] : copies) {
    std::filesystem::create_directories(folder / to);
    std::filesystem::copy_file(real / name, folder / to / "000000.png");
  }
  nn::write_file(folder / "rgb.txt", "0.0 rgb/000000.png\n");
  nn::write_file(folder / "depth.txt", "0.0 depth/000000.png\n");
  const test::ProgramResult result = test::run_penumbra(
      fmt::format("eval-masks '{0}' --people-masks '{0}/people' --mask-margin 8", folder.string()));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto [left, lost] = shares_of("adaptive", result.out);
  EXPECT_GE(left, 0.0) << result.out;
  EXPECT_LE(left, 8.0) << result.out;
  EXPECT_GE(lost, 0.0) << result.out;
  EXPECT_LE(lost, 10.0) << result.out;
  EXPECT_GE(shares_of("paper", result.out).first, 2.0 * left) << "the letter splits the body\n" << result.out;
}

TEST(EvalMasksCommand, SaysWhereItCannotWritePicturesAndWhatMasksItExpects) {
  const test::TemporaryDirectory folder;
  const std::string rgbd = (folder / "rgbd").string();
  ASSERT_EQ(test::run_penumbra("synth --sensor rgbd --frames 2 --size 310x94 --annotations --out " + rgbd)
                .exit_code,
            0);
  const test::ProgramResult pictures =
      test::run_penumbra(fmt::format("eval-masks '{0}' --pictures '{0}/rgb.txt/steps'", rgbd));
  EXPECT_EQ(pictures.exit_code, 1);
  for (const char* part : {"--pictures: expected a folder", "rgb.txt/steps"})
    EXPECT_NE(pictures.err.find(part), std::string::npos) << pictures.err;
  const test::ProgramResult masks =
      test::run_penumbra(fmt::format("eval-masks '{0}' --people-masks '{0}/empty'", rgbd));
  EXPECT_EQ(masks.exit_code, 1);
  EXPECT_NE(masks.err.find("empty: expected"), std::string::npos) << masks.err;
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
