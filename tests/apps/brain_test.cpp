#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "slam/brain/map/map_file.h"
#include "slam/geometry/trajectory_io.h"
#include "tests/support/browser.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

// A few metres of a made street, and runs over it.
class BrainCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared = std::make_unique<test::TemporaryDirectory>();
    const auto synth = test::run_penumbra(
        fmt::format("synth --path straight --frames 24 --size 310x94 --colour --out '{}'", street()));
    ASSERT_EQ(synth.exit_code, 0) << synth.err;
  }
  static void TearDownTestSuite() { shared.reset(); }
  static std::string street() { return shared->path().string() + "/street"; }
  static std::string out(const std::string& name) { return shared->path().string() + "/" + name; }
  static std::string weights() {
    return "--weights '" + test::source_path("weights_tools/models/penumbra-interest.safetensors").string() +
           "'";
  }
  static nlohmann::json run_of(const std::string& name) {
    return nlohmann::json::parse(test::read_file(out(name) + "/run.json"));
  }
  static void write_odometry(const std::string& text) { test::write_file(*shared / "odometry.txt", text); }
  static std::string error_with_odometry(const std::string& text) {
    write_odometry(text);
    const auto run =
        test::run_penumbra(fmt::format("brain '{}' --templates intensity --odometry '{}' --out '{}'",
                                       street(), out("odometry.txt"), out("wheels")));
    EXPECT_EQ(run.exit_code, 1) << run.out;
    return run.err;
  }

  static std::unique_ptr<test::TemporaryDirectory> shared;
};
std::unique_ptr<test::TemporaryDirectory> BrainCommand::shared;

TEST_F(BrainCommand, LeavesTrajectoriesMapAndPictures) {
  const auto run = test::run_penumbra(
      fmt::format("brain '{}' {} --noise noisy --seed 3 --out '{}'", street(), weights(), out("run")));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_CONTAINS(run.out, "24 frames");
  EXPECT_EQ(slam::read_kitti_trajectory(out("run") + "/trajectory_kitti.txt").size(), 24U);
  for (const char* file : {"trajectory_tum.txt", "trajectory.svg", "believed.svg", "cognitive_map.svg",
                           "error.svg", "places.png"})
    EXPECT_TRUE(std::filesystem::exists(out("run") + "/" + file)) << file;
  const nlohmann::json json = run_of("run");
  EXPECT_EQ(json["frames"], 24);
  EXPECT_EQ(json["templates"], "landmarks");
  EXPECT_TRUE(json["loops"].empty());
  EXPECT_LT(json["ground_truth"]["ape_rmse_m"], 1.0);
  const nlohmann::json map = nlohmann::json::parse(test::read_file(out("run") + "/cognitive_map.json"));
  EXPECT_EQ(map["nodes"].size(), json["nodes"]);
  EXPECT_EQ(map["links"].size(), json["links"]);
}

TEST_F(BrainCommand, IsAPageThatShowsItsMap) {
  ASSERT_EQ(test::run_penumbra(fmt::format("brain '{}' --templates intensity --noise noisy --out '{}'",
                                           street(), out("paged")))
                .exit_code,
            0);
  const auto report = test::run_penumbra(fmt::format("report '{}'", out("paged")));
  ASSERT_EQ(report.exit_code, 0) << report.err;
  EXPECT_EQ(test::run_penumbra(
                fmt::format("eval-loops '{}' --groundtruth '{}/poses/00.txt'", out("paged"), street()))
                .exit_code,
            0);
  const std::string browser = test::find_browser();
  if (browser.empty()) GTEST_SKIP() << test::kNoBrowser;
  const std::string dom = test::dump_dom(browser, "file://" + out("paged") + "/report.html");
  EXPECT_CONTAINS(dom, "data-ready=\"yes\"");
  for (const char* id : {"top", "error", "time", "cognitive"}) EXPECT_TRUE(test::is_drawn(dom, id)) << id;
  EXPECT_CONTAINS(dom, fmt::format("{} nodes", run_of("paged")["nodes"].get<int>()));
}

TEST_F(BrainCommand, IsTheSameWithOneAndTwoThreads) {
  for (const char* threads : {"1", "2"}) {
    const auto run =
        test::run_penumbra(fmt::format("brain '{}' {} --threads {} --out '{}'", street(), weights(), threads,
                                       out(std::string("threads") + threads)));
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  for (const char* file : {"trajectory_kitti.txt", "cognitive_map.json"}) {
    EXPECT_EQ(test::read_file(out("threads1") + "/" + file), test::read_file(out("threads2") + "/" + file));
  }
}

TEST_F(BrainCommand, FindsItsWayInASavedMap) {
  const std::string map = out("street.brain");
  ASSERT_EQ(test::run_penumbra(
                fmt::format("brain '{}' --templates intensity --noise none --save-map '{}' --out '{}'",
                            street(), map, out("saved")))
                .exit_code,
            0);
  EXPECT_GT(slam::brain::read_cognitive_map(map).map.size(), 3);
  const auto run = test::run_penumbra(fmt::format(
      "brain '{}' --templates intensity --noise noisy --seed 5 --frames 6:24 --load-map '{}' --out '{}'",
      street(), map, out("loaded")));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = run_of("loaded");
  EXPECT_TRUE(json["located"]);
  EXPECT_GT(json["recalls"].size(), 3U);
  // In the world of the saved run, which began six frames earlier.
  const slam::Trajectory whole = slam::read_kitti_trajectory(out("saved") + "/trajectory_kitti.txt"),
                         later = slam::read_kitti_trajectory(out("loaded") + "/trajectory_kitti.txt");
  EXPECT_LT((whole.back().T_wc.translation - later.back().T_wc.translation).norm(), 0.5);

  const auto other = test::run_penumbra(
      fmt::format("brain '{}' {} --load-map '{}' --out '{}'", street(), weights(), map, out("other")));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_CONTAINS(other.err, "street.brain");
  EXPECT_CONTAINS(other.err, "intensity");
}

TEST_F(BrainCommand, TakesWheelOdometry) {
  std::string text = "# time v omega\n";
  for (int i = 0; i <= 60; ++i) text += fmt::format("{:.3f} 9.0 0.0\n", 0.05 * i - 0.2);
  write_odometry(text);
  const auto run = test::run_penumbra(
      fmt::format("brain '{}' --templates intensity --sight off --odometry '{}' --out '{}'", street(),
                  out("odometry.txt"), out("wheels")));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const slam::Trajectory found = slam::read_kitti_trajectory(out("wheels") + "/trajectory_kitti.txt");
  EXPECT_NEAR((found[20].T_wc.translation - found[10].T_wc.translation).norm(), 9.0, 0.01);
}

TEST_F(BrainCommand, NamesWhatIsWrongWithOdometry) {
  EXPECT_CONTAINS(error_with_odometry("0 1 0\n1 nan 0\n"), "odometry.txt:2");
  EXPECT_CONTAINS(error_with_odometry("1 1 0\n0 1 0\n"), "odometry.txt:2");
  EXPECT_CONTAINS(error_with_odometry("1000 1 0\n1001 1 0\n"), "times of the images");
  EXPECT_CONTAINS(error_with_odometry("0 1\n1 1\n"), "2 numbers");
}

TEST_F(BrainCommand, OdometryOfAnotherUnitIsDoubted) {
  std::string text;
  for (int i = 0; i <= 60; ++i) text += fmt::format("{:.3f} 30.0 0.0\n", 0.05 * i - 0.2);  // km/h
  write_odometry(text);
  const auto run =
      test::run_penumbra(fmt::format("brain '{}' --templates intensity --odometry '{}' --out '{}'", street(),
                                     out("odometry.txt"), out("kmh")));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_CONTAINS(run.err, "metres a second");
  EXPECT_CONTAINS(error_with_odometry("0 1e300 0\n3 1e300 0\n"), "at most 1000 m/s");
}

TEST_F(BrainCommand, AMapThatCannotBeWrittenCostsOnlyItself) {
  const auto folder = test::run_penumbra(fmt::format(
      "brain '{0}' --templates intensity --save-map '{0}' --out '{1}'", street(), out("nowhere")));
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_CONTAINS(folder.err, "--save-map");
  const auto full = test::run_penumbra(
      fmt::format("brain '{}' --templates intensity --noise none --save-map /dev/full --out '{}'", street(),
                  out("full")));
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_CONTAINS(full.err, "/dev/full");
  EXPECT_EQ(run_of("full")["frames"], 24);
}

TEST_F(BrainCommand, GapsInOdometryAreSaid) {
  write_odometry("0 1 0\n0.1 1 0\n2.0 1 0\n");
  const auto run =
      test::run_penumbra(fmt::format("brain '{}' --templates intensity --odometry '{}' --out '{}'", street(),
                                     out("odometry.txt"), out("gaps")));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_CONTAINS(run.err, "gap");
}

TEST_F(BrainCommand, SaysWhichOptionsItMisses) {
  EXPECT_CONTAINS(test::run_penumbra("brain").err, "folder of a sequence");
  EXPECT_CONTAINS(test::run_penumbra(fmt::format("brain '{}'", street())).err, "--out");
  EXPECT_NE(
      test::run_penumbra(fmt::format("brain '{}' --noise loud --out '{}'", street(), out("x"))).exit_code, 0);
  const auto run = test::run_penumbra(
      fmt::format("brain '{}' --noise noisy --odometry o.txt --out '{}'", street(), out("x")));
  EXPECT_NE(run.exit_code, 0);
  EXPECT_CONTAINS(run.err, "--odometry");
}

TEST_F(BrainCommand, IsComparedWithRatslamAndSlam) {
  const auto bench = test::run_penumbra(
      fmt::format("bench brain '{}' {} --seeds 3 --out '{}'", street(), weights(), out("bench")));
  ASSERT_EQ(bench.exit_code, 0) << bench.err;
  const nlohmann::json rows = nlohmann::json::parse(test::read_file(out("bench") + "/brain.json"));
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_EQ(rows[0]["name"], "odometry");
  EXPECT_EQ(rows[5]["name"], "slam");
  EXPECT_TRUE(std::filesystem::exists(out("bench") + "/street-3/ours/error.svg"));
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row["precision"], 1.0) << row["name"];  // nothing comes twice, and nothing was recalled
    EXPECT_LT(row["ate_m"], 3.0) << row["name"];
  }
  const auto bad = test::run_penumbra(fmt::format("bench brain '{}' --rows cats", street()));
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_CONTAINS(bad.err, "cats");
}

}  // namespace
}  // namespace penumbra
