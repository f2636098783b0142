#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/test_data.h"

namespace penumbra {
namespace {

TEST(MatchEvalCommand, ShowsExamplesAndRefusesWrongArguments) {
  const test::ProgramResult help = test::run_penumbra("match-eval --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("penumbra match-eval kitti"), std::string::npos);
  EXPECT_EQ(test::run_penumbra("match-eval").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("match-eval x --threshold 0").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("match-eval /nowhere").exit_code, 1);
}

TEST(MatchEvalCommand, PrintsTheTableAndJsonOfASyntheticDrive) {
  const test::TemporaryDirectory folder;
  const std::string street = (folder / "street").string(), plot = (folder / "plot.svg").string();
  ASSERT_EQ(test::run_penumbra("synth --frames 4 --size 620x188 --out " + street).exit_code, 0);
  const test::ProgramResult table = test::run_penumbra(fmt::format("match-eval {} --plot {}", street, plot));
  ASSERT_EQ(table.exit_code, 0) << table.err;
  for (const char* part :
       {"ORB + paper filter", "ORB + adaptive filter", "ORB + compensated filter", "within 2 px"}) {
    EXPECT_NE(table.out.find(part), std::string::npos) << part;
  }
  EXPECT_TRUE(std::filesystem::exists(plot));

  const test::ProgramResult result =
      test::run_penumbra(fmt::format("match-eval {} --frames 0:3 --no-sift --json", street));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["sequences"].size(), 1U);
  EXPECT_EQ(json["sequences"][0]["image_pairs"], 2);
  EXPECT_EQ(json["threshold_px"], 2.0);
  EXPECT_FALSE(json["mean"].contains("SIFT"));
  const nlohmann::json& orb = json["mean"]["ORB"];
  EXPECT_GT(orb["pairs"], 100.0);
  EXPECT_GT(orb["effective_rate_percent"], 40.0);
  EXPECT_LE(orb["effective_pairs"], orb["pairs"]);
  EXPECT_EQ(json["variance"]["ORB"]["pairs"], 0.0);  // of one sequence
}

TEST(MatchEvalCommand, SequencesWithoutGroundTruthAreRefused) {
  const test::TemporaryDirectory folder;
  const std::string street = (folder / "street").string();
  ASSERT_EQ(test::run_penumbra("synth --frames 2 --size 310x94 --out " + street).exit_code, 0);
  std::filesystem::remove_all(folder / "street/poses");
  const test::ProgramResult result = test::run_penumbra("match-eval " + street);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("ground truth"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace penumbra
