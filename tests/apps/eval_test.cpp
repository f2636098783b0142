// `penumbra eval` from the outside: tables, JSON, the plot and exit codes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/geometry/trajectory_io.h"
#include "tests/support/test_data.h"
#include "tests/support/trajectories.h"

namespace penumbra::test {
namespace {

using nlohmann::json;

class Eval : public testing::Test {
 protected:
  void SetUp() override {
    const slam::Trajectory truth = winding_trajectory(60);
    slam::write_kitti_poses(path("truth.txt"), truth);
    slam::write_kitti_poses(path("estimate.txt"), disturbed(truth, 0.05, 0.01, 3));
    slam::write_tum_trajectory(path("truth_tum.txt"), truth);
    slam::write_tum_trajectory(path("estimate_tum.txt"), disturbed(truth, 0.05, 0.01, 3));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramResult eval(const std::string& truth, const std::string& estimate,
                     const std::string& more = "") const {
    return run_penumbra("eval --groundtruth " + path(truth) + " --estimate " + path(estimate) + " " + more);
  }
  TemporaryDirectory folder_;
};

void expect_failure(const ProgramResult& result, int exit_code, std::initializer_list<std::string> parts) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(result.out, "");
  for (const std::string& part : parts) {
    EXPECT_NE(result.err.find(part), std::string::npos) << "no '" << part << "' in: " << result.err;
  }
}

TEST_F(Eval, PrintsTablesForPeople) {
  const ProgramResult result = eval("truth.txt", "estimate.txt", "--segments 10,20,500");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* part : {"60 poses", "alignment se3", "APE (m)", "RPE 1 frame (deg)", "segments of 10 m",
                           "too short for two such steps", "all segments"}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part << " in\n" << result.out;
  }
  EXPECT_EQ(result.out.find("nan"), std::string::npos) << result.out;
}

TEST_F(Eval, PrintsJsonForMachines) {
  const ProgramResult result = eval("truth.txt", "estimate.txt", "--json --align sim3 --rpe-frames 5");
  EXPECT_EQ(result.exit_code, 0);
  const json report = json::parse(result.out);
  EXPECT_EQ(report["poses"], 60);
  EXPECT_EQ(report["alignment"]["mode"], "sim3");
  EXPECT_NEAR(report["alignment"]["scale"].get<double>(), 1.0, 0.01);
  EXPECT_EQ(report["ape_m"]["count"], 60);
  EXPECT_GT(report["ape_m"]["rmse"].get<double>(), 0.0);
  EXPECT_EQ(report["rpe_frames"]["frames"], 5);
  EXPECT_EQ(report["rpe_frames"]["translation_m"]["count"], 11);
  EXPECT_TRUE(report["rpe_metres"]["translation_m"].is_null());
  EXPECT_TRUE(report["kitti"]["t_rel_percent"].is_null());
  EXPECT_EQ(report["kitti"]["by_length"].size(), 8U);
}

TEST_F(Eval, APathShorterThanEverySegmentIsSaidInWords) {
  const ProgramResult result = eval("truth.txt", "estimate.txt");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("shorter than every segment (100 m and more)"), std::string::npos) << result.out;
}

TEST_F(Eval, TumAndKittiFilesGiveTheSameNumbers) {
  const json kitti = json::parse(eval("truth.txt", "estimate.txt", "--json").out);
  const json tum = json::parse(eval("truth_tum.txt", "estimate_tum.txt", "--json").out);
  EXPECT_EQ(tum["poses"], 60);
  EXPECT_NEAR(kitti["ape_m"]["rmse"].get<double>(), tum["ape_m"]["rmse"].get<double>(), 1e-9);
  EXPECT_NEAR(kitti["rpe_frames"]["rotation_deg"]["mean"].get<double>(),
              tum["rpe_frames"]["rotation_deg"]["mean"].get<double>(), 1e-9);
}

TEST_F(Eval, FramesPickAPartOfTheGroundTruth) {
  const slam::Trajectory truth = winding_trajectory(60);
  slam::write_kitti_poses(path("part.txt"), slam::Trajectory(truth.begin() + 10, truth.begin() + 30));
  expect_failure(eval("truth.txt", "part.txt"), 1, {"part.txt", "60 poses", "found 20", "--frames A:B"});
  expect_failure(eval("truth.txt", "part.txt", "--frames 10:31"), 1,
                 {"21 poses", "truth.txt 10:31", "found 20"});
  expect_failure(eval("truth.txt", "part.txt", "--frames 50:70"), 1, {"truth.txt", "frames within 0:60"});
  const ProgramResult result = eval("truth.txt", "part.txt", "--frames 10:30 --align none --json");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out)["ape_m"]["max"], 0.0);
}

TEST_F(Eval, DrawsThePlot) {
  EXPECT_EQ(eval("truth.txt", "estimate.txt", "--plot " + path("plot.png")).exit_code, 0);
  EXPECT_GE(nn::read_image(path("plot.png"), nn::ImageColour::bgr).width(), 1000);
  EXPECT_EQ(eval("truth.txt", "estimate.txt", "--plot " + path("no/plot.png")).exit_code, 1);
  EXPECT_EQ(eval("truth.txt", "estimate.txt", "--plot " + path("plot.unknown")).exit_code, 1);
}

TEST_F(Eval, AStraightPathIsEvaluatedWithAWarning) {
  slam::write_kitti_poses(path("line.txt"), path_through({{0, 0, 0}, {0, 0, 1}, {0, 0, 3}}));
  const ProgramResult result = eval("line.txt", "line.txt");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("straight"), std::string::npos) << result.err;
}

TEST_F(Eval, BadInputGivesExitCode1) {
  expect_failure(eval("truth.txt", "nowhere.txt"), 1, {"nowhere.txt", "no such file"});
  nn::write_file(path("bad.txt"), "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 nan 0 1 0 0 0 0 1 0\n");
  expect_failure(eval("truth.txt", "bad.txt"), 1, {"bad.txt:2", "finite", "nan"});
  nn::write_file(path("three.txt"), "1 2 3\n");
  expect_failure(eval("truth.txt", "three.txt"), 1, {"three.txt:1", "12 numbers (KITTI", "8 (TUM)"});
  expect_failure(eval("truth.txt", "estimate.txt", "--format tum"), 1,
                 {"truth.txt:1", "8 numbers", "12 numbers"});
  expect_failure(eval("truth_tum.txt", "estimate_tum.txt", "--max-time-difference 0 --format kitti"), 1,
                 {"truth_tum.txt:2", "12 numbers"});
}

TEST_F(Eval, WrongArgumentsGiveExitCode2) {
  EXPECT_EQ(run_penumbra("eval").exit_code, 2);
  EXPECT_EQ(run_penumbra("eval --help").exit_code, 0);
  expect_failure(eval("truth.txt", "estimate_tum.txt"), 2, {"kitti", "tum"});
  expect_failure(eval("truth.txt", "estimate.txt", "--frames 5"), 2, {"'5'", "A:B"});
  expect_failure(eval("truth_tum.txt", "estimate_tum.txt", "--frames 0:5"), 2, {"--frames is for KITTI"});
  for (const char* more :
       {"--align affine", "--format csv", "--segments 0", "--segments 10,-5", "--segments x",
        "--segments nan", "--rpe-frames 0", "--rpe-metres -1", "--rpe-metres nan"}) {
    EXPECT_EQ(eval("truth.txt", "estimate.txt", more).exit_code, 2) << more;
  }
}

}  // namespace
}  // namespace penumbra::test
