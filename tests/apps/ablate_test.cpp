// penumbra ablate: a table that is finished later, from the cells that are there.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "nn/base/file.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

TEST(Ablate, FillsATableAndDoesNotRunCellsTwice) {
  const TemporaryDirectory folder;
  const std::string command = "ablate --presets lorry --frames 6 --seeds 1 --size 310x94 --json --out '" +
                              (folder / "out").string() + "' --masks ";
  const ProgramResult first = run_penumbra(command + "none");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(nlohmann::json::parse(first.out).size(), 1U);
  const auto cell = folder / "out/cells/lorry_310x94_6_seed1_none_adaptive.json";
  ASSERT_TRUE(std::filesystem::exists(cell));
  const auto written = std::filesystem::last_write_time(cell);

  const ProgramResult second = run_penumbra(command + "none,truth");
  ASSERT_EQ(second.exit_code, 0) << second.err;
  const nlohmann::json rows = nlohmann::json::parse(second.out);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["masks"], "none");
  EXPECT_EQ(rows[1]["masks"], "truth");
  EXPECT_TRUE(rows[1]["ate_m"].contains("mean"));
  EXPECT_EQ(std::filesystem::last_write_time(cell), written);
}

TEST(BenchDynamics, ComparesAllWaysAndDrawsThem) {
  const TemporaryDirectory folder;
  const ProgramResult result =
      run_penumbra("bench dynamics --presets sitting-static --seeds 1 --frames 12 --out '" +
                   (folder / "out").string() + "'");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* way :
       {"none", "boxes", "clusters", "dbscan", "static-boxes", "static-paper", "static-points", "truth"}) {
    EXPECT_NE(result.out.find(std::string("| sitting-static | ") + way + " |"), std::string::npos) << way;
    for (const char* ending : {"json", "svg", "png"}) {
      EXPECT_TRUE(std::filesystem::exists(
          folder / fmt::format("out/cells/sitting-static_640x480_12_seed1_{}_adaptive.{}", way, ending)));
    }
  }
  const nlohmann::json rows = nlohmann::json::parse(nn::read_file(folder / "out/dynamics.json", "a table"));
  EXPECT_EQ(rows.size(), 8U);
  for (const nlohmann::json& row : rows) {
    EXPECT_GE(row.at("moving_recall").at("mean").get<double>(), 0.0);
    EXPECT_LE(row.at("standing_kept").at("mean").get<double>(), 1.0);
  }
  // Without masks nothing is left out.
  EXPECT_EQ(rows[0].at("standing_kept").at("mean"), 1.0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/dynamics.html"));
  EXPECT_EQ(run_penumbra("bench dynamics --presets easy --out '" + (folder / "out").string() + "'").exit_code,
            2);
}

TEST(Ablate, RefusesWhatItCannotMeasure) {
  const TemporaryDirectory folder;
  const std::string command = "ablate --frames 6 --out '" + (folder / "out").string() + "' ";
  for (const char* wrong : {"--masks geometry", "--masks some", "--size 620", "--presets motorway"}) {
    const ProgramResult result = run_penumbra(command + wrong);
    EXPECT_EQ(result.exit_code, 2) << wrong << result.err;
  }
}

}  // namespace
}  // namespace penumbra::test
