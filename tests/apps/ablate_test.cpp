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

TEST(Ablate, TakesOnlyWholeResultsOfTheSameCell) {
  const TemporaryDirectory folder;
  const std::string command =
      "ablate --presets lorry --frames 6 --seeds 1 --size 310x94 --masks none --out '" +
      (folder / "out").string() + "'";
  ASSERT_EQ(run_penumbra(command).exit_code, 0);
  const auto cell = folder / "out/cells/lorry_310x94_6_seed1_none_adaptive.json";
  const std::string whole = nn::read_file(cell, "a cell");
  nlohmann::json torn = nlohmann::json::parse(whole), other = torn;
  torn.erase("ate_m");
  other["seed"] = 2;
  for (const std::string& text :
       {std::string("{}"), whole.substr(0, whole.size() / 2), torn.dump(), other.dump()}) {
    nn::write_file(cell, text);
    const ProgramResult again = run_penumbra(command);
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NE(again.err.find("made anew"), std::string::npos) << again.err;
    const nlohmann::json made = nlohmann::json::parse(nn::read_file(cell, "a cell"));
    EXPECT_EQ(made["ate_m"], nlohmann::json::parse(whole)["ate_m"]);
  }
  // What else lies there does not matter.
  nn::write_file(folder / "out/cells/lorry_310x94_6_seed1_none_adaptive (copy).json", "{");
  EXPECT_EQ(run_penumbra(command).exit_code, 0);
}

TEST(Ablate, TellsNetworksApartByTheirContent) {
  const TemporaryDirectory folder;
  const std::string models = source_path("weights_tools/models").string();
  const std::string command = "ablate --presets sitting-static --frames 4 --seeds 1 --masks boxes --out '" +
                              (folder / "out").string() + "' --weights a='" + models;
  const auto cell = folder / "out/cells/sitting-static_640x480_4_seed1_boxes-a_adaptive.json";
  const auto content = [&] {
    return nlohmann::json::parse(nn::read_file(cell, "a cell")).at("weights_content").get<std::string>();
  };
  ASSERT_EQ(run_penumbra(command + "/penumbra-office.safetensors'").exit_code, 0);
  const std::string first = content();
  ASSERT_EQ(run_penumbra(command + "/penumbra-afnet.safetensors'").exit_code, 0);
  EXPECT_NE(content(), first) << "another network of the same name";
  const auto written = std::filesystem::last_write_time(cell);
  ASSERT_EQ(run_penumbra(command + "/penumbra-afnet.safetensors'").exit_code, 0);
  EXPECT_EQ(std::filesystem::last_write_time(cell), written);
}

TEST(Ablate, SaysWhichRecordingHasNoTruthAboutPoints) {
  const TemporaryDirectory folder;
  const std::string command =
      "ablate --presets sitting-static --frames 4 --seeds 1 --masks none,truth --out '" +
      (folder / "out").string() + "'";
  ASSERT_EQ(run_penumbra(command).exit_code, 0);
  std::filesystem::remove_all(folder / "out/cells");
  std::filesystem::remove_all(folder / "out/drives/sitting-static_640x480_4_seed1/flow");
  const ProgramResult result = run_penumbra(command);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string warning = "sitting-static_640x480_4_seed1: no flow";
  const std::size_t at = result.err.find(warning);
  ASSERT_NE(at, result.err.npos) << result.err;
  EXPECT_EQ(result.err.find(warning, at + 1), result.err.npos) << "once";
}

TEST(Ablate, RefusesWhatItCannotMeasure) {
  const TemporaryDirectory folder;
  const std::string command = "ablate --frames 6 --out '" + (folder / "out").string() + "' ";
  for (const char* wrong : {"--masks geometry", "--masks some", "--size 620", "--presets motorway",
                            "--masks boxes --weights a/b=c.safetensors"}) {
    const ProgramResult result = run_penumbra(command + wrong);
    EXPECT_EQ(result.exit_code, 2) << wrong << result.err;
  }
}

}  // namespace
}  // namespace penumbra::test
