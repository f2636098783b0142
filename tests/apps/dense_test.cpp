#include <fmt/core.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "apps/view/slam_report.h"
#include "nn/image/image_file.h"
#include "slam/map/dense/cloud_files.h"
#include "slam/map/dense/occupancy_grid.h"
#include "slam/sources/bag/message_source.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

// A made desk, a run through it with its exact masks, and its dense map.
class DenseRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared = std::make_unique<test::TemporaryDirectory>();
    const std::string folder = shared->path().string();
    const auto synth = test::run_penumbra(fmt::format(
        "synth --scene office --preset desk --frames 20 --size 320x240 --out '{}/office'", folder));
    ASSERT_EQ(synth.exit_code, 0) << synth.err;
    const auto slam = test::run_penumbra(fmt::format("slam '{0}/office' --dense --out '{0}/run'", folder));
    ASSERT_EQ(slam.exit_code, 0) << slam.err;
  }
  static void TearDownTestSuite() { shared.reset(); }
  static std::string folder() { return shared->path().string(); }

  static std::unique_ptr<test::TemporaryDirectory> shared;
};
std::unique_ptr<test::TemporaryDirectory> DenseRun::shared;

TEST_F(DenseRun, LeavesAMapAndItsFigures) {
  const slam::DenseCloud cloud = slam::read_dense_ply(*shared / "run/dense.ply");
  const nlohmann::json run = nlohmann::json::parse(test::read_file(*shared / "run/run.json"));
  EXPECT_GT(cloud.places.size(), 10'000U);
  EXPECT_EQ(run["dense"]["voxels"], cloud.places.size());
  EXPECT_EQ(run["dense"]["classes"], nlohmann::json(cloud.classes));
  EXPECT_TRUE(std::filesystem::exists(*shared / "run/dense.pcd"));
  EXPECT_EQ(std::filesystem::exists(*shared / "run/plan.pgm"), run["dense"]["floor"].get<bool>());
  EXPECT_EQ(run["dense"].contains("plan_from_map"), run["dense"]["floor"].get<bool>());
}

TEST_F(DenseRun, AgreesWithTheTruth) {
  const auto eval =
      test::run_penumbra(fmt::format("eval-dense '{0}/run' --truth '{0}/office' --every 2 --json", folder()));
  ASSERT_EQ(eval.exit_code, 0) << eval.err;
  const nlohmann::json score = nlohmann::json::parse(eval.out);
  EXPECT_LT(score["median_error_m"], 0.02);
  EXPECT_GT(score["completeness"], 0.8);
  EXPECT_LT(score["ghosts"], 0.001);
}

TEST_F(DenseRun, AgreesWithTheTruthOfACameraWithOtherLevels) {
  // A D435 has 1000 levels a metre, and so has the true depth beside it.
  const std::string made = folder() + "/d435";
  ASSERT_EQ(
      test::run_penumbra(fmt::format("synth --scene office --preset desk --depth-sensor d435 --frames 10 "
                                     "--size 320x240 --out '{}'",
                                     made))
          .exit_code,
      0);
  ASSERT_EQ(test::run_penumbra(fmt::format("slam '{0}' --dense --out '{0}_run'", made)).exit_code, 0);
  const auto eval =
      test::run_penumbra(fmt::format("eval-dense '{0}_run' --truth '{0}' --every 2 --json", made));
  ASSERT_EQ(eval.exit_code, 0) << eval.err;
  const nlohmann::json score = nlohmann::json::parse(eval.out);
  EXPECT_LT(score["median_error_m"], 0.02);
  EXPECT_GT(score["completeness"], 0.8);
}

TEST_F(DenseRun, IsInTheReport) {
  ASSERT_EQ(test::run_penumbra(fmt::format("report '{}/run'", folder())).exit_code, 0);
  const std::string page = test::read_file(*shared / "run/report.html");
  EXPECT_NE(page.find("\"dense\":{\"classes\":[\"\"]"), page.npos);
}

TEST_F(DenseRun, DoesNotOutliveItself) {
  // A run without --dense in the same folder leaves no map of the one before.
  std::filesystem::copy(*shared / "run", *shared / "again", std::filesystem::copy_options::recursive);
  ASSERT_EQ(
      test::run_penumbra(fmt::format("slam '{0}/office' --frames 0:4 --out '{0}/again'", folder())).exit_code,
      0);
  for (const char* name : {"dense.ply", "dense.pcd", "plan.pgm", "plan.yaml"})
    EXPECT_FALSE(std::filesystem::exists(*shared / "again" / name)) << name;
}

TEST_F(DenseRun, MapsAStreetFromPairsOfImages) {
  const std::string street = folder() + "/street";
  ASSERT_EQ(test::run_penumbra(fmt::format("synth --frames 16 --size 1240x376 --seed 3 --out '{}'", street))
                .exit_code,
            0);
  const auto slam = test::run_penumbra(
      fmt::format("slam '{0}' --dense --grid-resolution 0.25 --deterministic --out '{0}_run'", street));
  ASSERT_EQ(slam.exit_code, 0) << slam.err;
  const nlohmann::json run = nlohmann::json::parse(test::read_file(street + "_run/run.json"));
  EXPECT_NEAR(run["dense"]["voxel_m"].get<double>(), 0.125, 1e-9);
  EXPECT_GT(run["stages"]["stereo_depth"], 0.0);
  EXPECT_EQ(run["dense"]["cell_m"], 0.25);
  EXPECT_NEAR(run["dense"]["depth_to_m"].get<double>(), 14.0, 1.0);
  // Its camera is 1.65 m above the road and sees it from 6 m on.
  EXPECT_NEAR(run["dense"]["floor_from_m"].get<double>(), 6.2, 0.5);
  EXPECT_NE(test::read_file(street + "_run/plan.yaml").find("resolution: 0.25\n"), std::string::npos);
  const auto eval = test::run_penumbra(fmt::format("eval-dense '{0}_run' --truth '{0}' --json", street));
  ASSERT_EQ(eval.exit_code, 0) << eval.err;
  const nlohmann::json score = nlohmann::json::parse(eval.out)["plan"];
  EXPECT_GT(score["free_m2"], 60.0) << eval.out;
  EXPECT_GT(score["free_right"], 0.98) << eval.out;
  EXPECT_GT(score["blocked_m2"], 8.0) << eval.out;
  EXPECT_GT(score["blocked_within_a_cell"], 0.95) << eval.out;
  EXPECT_GT(score["obstacles_within_a_cell"], 0.85) << eval.out;

  // The plan is in what is exported, too.
  const std::string mcap = folder() + "/street.mcap";
  ASSERT_EQ(test::run_penumbra(fmt::format("export '{}_run' --mcap '{}'", street, mcap)).exit_code, 0);
  const auto source = slam::open_bag(mcap);
  const ByteImage plan = nn::read_image(street + "_run/plan.pgm", nn::ImageColour::grey);
  // ROS: white is free, black blocked, grey unknown; rows from the lower left corner on.
  const std::map<std::uint8_t, char> cell_of = {{254, 0}, {0, 100}, {205, -1}};
  std::string cells;
  for (int y = plan.height() - 1; y >= 0; --y) {
    for (int x = 0; x < plan.width(); ++x) cells += cell_of.at(plan.at(x, y));
  }
  int plans = 0;
  source->read_all([&](const slam::Message& message) {
    if (source->topics()[message.topic].name == "/plan") plans += message.bytes.ends_with(cells);
  });
  EXPECT_EQ(plans, 1);
}

// How far depth counts and where the floor begins say why there is no plan, or little of it.
TEST(PlanDoubt, HasTheFigures) {
  slam::DenseSettings settings;
  settings.plan.cell = 0.1;
  settings.fusion.farthest = 6.5;
  slam::DenseMap map{.voxels = slam::VoxelGrid(0.05), .classes = {}, .floor = {}, .plan = {}};
  const std::string of_depth = apps::plan_doubt(map, settings, slam::Sensor::rgbd);
  EXPECT_NE(of_depth.find("6.5 m; dense.farthest"), std::string::npos) << of_depth;
  EXPECT_EQ(of_depth.find("--grid-resolution"), std::string::npos) << of_depth;
  const std::string none = apps::plan_doubt(map, settings, slam::Sensor::stereo);
  EXPECT_NE(none.find("no floor was found"), std::string::npos) << none;
  EXPECT_NE(none.find("6.5 m with cells of 0.1 m"), std::string::npos) << none;
  EXPECT_NE(none.find("as 0.2 about 9.19 m"), std::string::npos) << none;
  map.floor.emplace();
  map.plan.emplace();
  map.floor_from = 6.2;
  const std::string strip = apps::plan_doubt(map, settings, slam::Sensor::stereo);
  EXPECT_NE(strip.find("6.2 m ahead"), std::string::npos) << strip;
  settings.fusion.farthest = 12.5;
  EXPECT_EQ(apps::plan_doubt(map, settings, slam::Sensor::stereo), "");
}

TEST_F(DenseRun, RefusesWhatHasNoTruth) {
  std::filesystem::create_directories(*shared / "empty");
  const auto none = test::run_penumbra(fmt::format("eval-dense '{0}/run' --truth '{0}/empty'", folder()));
  EXPECT_NE(none.exit_code, 0);
  EXPECT_NE(none.err.find("instances.json"), none.err.npos) << none.err;
  const auto no_map =
      test::run_penumbra(fmt::format("eval-dense '{0}/empty' --truth '{0}/office'", folder()));
  EXPECT_NE(no_map.err.find("dense.ply"), no_map.err.npos) << no_map.err;
  std::filesystem::create_directories(*shared / "bare/sequences");
  const auto no_plan = test::run_penumbra(fmt::format("eval-dense '{0}/run' --truth '{0}/bare'", folder()));
  EXPECT_NE(no_plan.err.find("plan.yaml"), no_plan.err.npos) << no_plan.err;
}

}  // namespace
}  // namespace penumbra
