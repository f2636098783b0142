// `penumbra eval-loops` from the outside, on a run made by hand: a circle of 100 m, a metre a frame, one lap
// and 30 m.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "nn/base/file.h"
#include "slam/geometry/trajectory_io.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

using nlohmann::json;

class EvalLoops : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 140; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 100.0, radius = 50.0 / std::numbers::pi;
      slam::SE3 T_wc;
      T_wc.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
      T_wc.translation = {radius * (1.0 - std::cos(angle)), 0.0, radius * std::sin(angle)};
      truth.push_back({0.1 * i, T_wc});
    }
    slam::write_kitti_poses(folder / "poses.txt", truth);
    // Frames 10 to 139 were run; with frame 10 the lap begins.
    for (int i = 10; i < 140; ++i) {
      frames["index"].push_back(i);
      frames["timestamp"].push_back(0.1 * i);
    }
    run["loops"] = {{112, 13}, {120, 80}};
    run["keyframe_frames"] = {10, 16, 26, 106, 116, 126, 136};
    run["covisibility"] = {{116, 106, 90}, {116, 16, 60}, {126, 26, 55}};
  }
  ProgramResult evaluate(const std::string& options = "", const std::string& truth_file = "poses.txt") const {
    nn::write_file(folder / "run.json", run.dump());
    nn::write_file(folder / "frames.json", frames.dump());
    return run_penumbra("eval-loops " + folder.path().string() + " --groundtruth " +
                        (folder / truth_file).string() + " " + options);
  }
  TemporaryDirectory folder;
  slam::Trajectory truth;
  json run, frames;
};

TEST_F(EvalLoops, CountsByHand) {
  const ProgramResult result = evaluate("--json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json found = json::parse(result.out);
  EXPECT_EQ(found["loops"], 2);
  EXPECT_EQ(found["correct_loops"], 1);
  EXPECT_EQ(found["precision"], 0.5);
  ASSERT_EQ(found["regions"].size(), 1U);
  EXPECT_EQ(found["regions"][0]["first_frame"], 105);
  EXPECT_EQ(found["regions"][0]["last_frame"], 139);
  EXPECT_EQ(found["region_recall"], 1.0);
  EXPECT_EQ(found["revisited_keyframes"], 4);
  EXPECT_EQ(found["tied_keyframes"], 2);
  ASSERT_EQ(found["wrong_loops"].size(), 1U);
  EXPECT_EQ(found["wrong_loops"][0]["frame"], 120);
  const ProgramResult table = evaluate();
  EXPECT_NE(table.out.find("precision   50.0 %"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("frames   105 to   139 go where    10 went: closed"), std::string::npos)
      << table.out;
}

TEST_F(EvalLoops, TakesATumFileByItsTimes) {
  slam::write_tum_trajectory(folder / "truth_tum.txt", truth);
  const ProgramResult result = evaluate("--json", "truth_tum.txt");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out)["correct_loops"], 1);
}

TEST_F(EvalLoops, NamesWhatIsWrong) {
  EXPECT_EQ(run_penumbra("eval-loops").exit_code, 2);
  const auto expect_error = [&](const std::string& part) {
    const ProgramResult result = evaluate();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  run["loops"] = {{112}};
  expect_error("'loops'");
  run["loops"] = {{112, "a"}};
  expect_error("'loops'");
  run["loops"] = {{112, 300}};
  expect_error("frame 300");
  run["loops"] = json::array();
  run.erase("covisibility");
  expect_error("'covisibility'");
  run = json::array();
  expect_error("run.json");
}

TEST_F(EvalLoops, NamesAFrameWithoutGroundTruth) {
  frames["index"].push_back(140);
  frames["timestamp"].push_back(14.0);
  const ProgramResult result = evaluate();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("frame 140"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace penumbra::test
