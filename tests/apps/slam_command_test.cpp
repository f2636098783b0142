#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "nn/io/safetensors.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(SlamCommand, ShowsExamples) {
  const test::ProgramResult result = test::run_penumbra("slam --help");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("penumbra slam kitti"), std::string::npos);
}

TEST(SlamCommand, RefusesWrongArgumentsWithExitCode2) {
  EXPECT_EQ(test::run_penumbra("slam").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("slam somewhere").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("slam somewhere --out x --filter sometimes").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("slam somewhere --out x --frames 7:3").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("slam somewhere --out x --threads 0").exit_code, 2);
  EXPECT_EQ(test::run_penumbra("slam somewhere --out x --least-sharpness 2").exit_code, 2);
}

TEST(SlamCommand, NamesTheFolderThatIsMissing) {
  const test::TemporaryDirectory folder;
  const test::ProgramResult result = test::run_penumbra(
      fmt::format("slam '{}' --out '{}'", (folder / "nowhere").string(), (folder / "out").string()));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("nowhere"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

// With random weights everything is found everywhere; told that every class is a car, the SLAM leaves
// features out.
TEST(SlamCommand, LeavesFeaturesOnMovableInstancesOut) {
  const test::TemporaryDirectory folder;
  nn::write_safetensors(folder / "weights.safetensors", test::random_mask_rcnn(false));
  std::ofstream names(folder / "names.txt");
  for (int c = 1; c < 91; ++c) names << "car\n";
  names.close();
  ASSERT_EQ(
      test::run_penumbra("synth --frames 2 --size 310x94 --out " + (folder / "street").string()).exit_code,
      0);
  const auto movable_features = [&](const std::string& options) {
    const test::ProgramResult result = test::run_penumbra(fmt::format(
        "slam '{0}/street' --out '{0}/out' --weights '{0}/weights.safetensors' --classes '{0}/names.txt' {1}",
        folder.path().string(), options));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(contents(folder / "out" / "run.json")).at("movable_features").get<int>();
  };
  EXPECT_GT(movable_features("--segmentation all"), 0);
  EXPECT_EQ(movable_features("--segmentation off"), 0);
}

TEST(SlamCommand, TakesMasksInsteadOfANetwork) {
  const test::TemporaryDirectory folder;
  const std::string street = (folder / "street").string();
  ASSERT_EQ(test::run_penumbra("synth --preset lorry --frames 8 --out " + street).exit_code, 0);
  const std::string run =
      fmt::format("slam '{0}' --out '{0}/out' --masks '{0}/sequences/00/instances' ", street);
  const test::ProgramResult result = test::run_penumbra(run + "--deterministic");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = nlohmann::json::parse(contents(folder / "street/out/run.json"));
  EXPECT_GT(report["movable_features"], 0);
  bool lorry_moves = false;
  for (const nlohmann::json& instance : report["instances"]) {
    lorry_moves = lorry_moves || (instance["class"] == "truck" && instance["state"] == "moving" &&
                                  instance["speed_mps"].get<double>() > 4.0);
  }
  EXPECT_TRUE(lorry_moves) << report["instances"].dump();

  const test::ProgramResult wrong = test::run_penumbra(run + "--segmentation every-0");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("--segmentation"), std::string::npos) << wrong.err;
  std::ofstream(folder / "street/sequences/00/instances.json") << "[1, 2";
  const test::ProgramResult torn = test::run_penumbra(run);
  EXPECT_EQ(torn.exit_code, 1);
  EXPECT_NE(torn.err.find("instances.json"), std::string::npos) << torn.err;
}

// Exact masks' boxes stand for a detector's.
TEST(SlamCommand, MakesMasksOfBoxesByDepth) {
  const test::TemporaryDirectory folder;
  const std::string office = (folder / "office").string();
  ASSERT_EQ(test::run_penumbra("synth --scene office --frames 5 --annotations --size 320x240 --out " + office)
                .exit_code,
            0);
  const auto run = [&](const std::string& options) {
    return test::run_penumbra(
        fmt::format("slam '{0}' --out '{0}/out' --deterministic --segmentation all {1}", office, options));
  };
  const std::string masks = fmt::format("--masks '{}/instances' ", office);
  const auto movable = [&](const std::string& options) {
    const test::ProgramResult result = run(options);
    EXPECT_EQ(result.exit_code, 0) << options << result.err;
    return nlohmann::json::parse(contents(folder / "office/out/run.json")).at("movable_features").get<int>();
  };
  const int exact = movable(masks + "--moving class"), boxes = movable(masks + "--dynamics boxes");
  const int clusters = movable(masks + "--dynamics depth-clusters");
  EXPECT_GT(exact, 0);
  EXPECT_GT(boxes, exact);
  EXPECT_GT(clusters, 0);
  EXPECT_LE(clusters, boxes);
  for (const char* options : {"--repair off", "--repair paper --clusters paper",
                              "--repair border --consistency off", "--repair median --moving geometry"})
    movable(masks + "--dynamics depth-clusters " + options);

  const test::ProgramResult nothing = run("--dynamics depth-clusters");
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_NE(nothing.err.find("needs --weights"), std::string::npos) << nothing.err;
  EXPECT_EQ(run(masks + "--dynamics guesses").exit_code, 2);
}

// People who sit: what is left out of them comes back.
TEST(SlamCommand, GivesBackPointsThatStand) {
  const test::TemporaryDirectory folder;
  const std::string office = (folder / "office").string();
  ASSERT_EQ(test::run_penumbra("synth --scene office --preset sitting-static --frames 16 --out " + office)
                .exit_code,
            0);
  const auto movable = [&](const std::string& options) {
    const test::ProgramResult result = test::run_penumbra(fmt::format(
        "slam '{0}' --masks '{0}/instances' --out '{0}/out' --deterministic {1}", office, options));
    EXPECT_EQ(result.exit_code, 0) << options << result.err;
    return nlohmann::json::parse(contents(folder / "office/out/run.json")).at("movable_features").get<int>();
  };
  const int left_out = movable("--moving class"),
            with_reach = movable("--dynamics static-points --static-points off");
  EXPECT_GT(left_out, 0);
  EXPECT_GT(with_reach, 0);
  for (const char* options : {"--static-points adaptive", "--static-points paper", "--dynamics static-points",
                              "--dynamics static-points --foreground paper --static-points paper"}) {
    movable(options);
    const auto points = nlohmann::json::parse(contents(folder / "office/out/run.json")).at("static_points");
    EXPECT_GT(points.at("left_out").get<int>(), 0) << options;
    EXPECT_GT(points.at("given_back").get<int>(), points.at("left_out").get<int>() / 20) << options;
    EXPECT_GT(points.at("compared").get<int>(), 0) << options;
  }
}

TEST(SlamCommand, NeedsDepthForDepthClusters) {
  const test::TemporaryDirectory folder;
  const std::string street = (folder / "street").string();
  ASSERT_EQ(test::run_penumbra("synth --frames 2 --size 310x94 --out " + street).exit_code, 0);
  const test::ProgramResult result = test::run_penumbra(fmt::format(
      "slam '{0}' --out '{0}/out' --masks '{0}/sequences/00/instances' --dynamics depth-clusters", street));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("RGB-D"), std::string::npos) << result.err;
  const std::string masks =
      fmt::format("slam '{0}' --out '{0}/out' --masks '{0}/sequences/00/instances' ", street);
  const test::ProgramResult by_points = test::run_penumbra(masks + "--dynamics static-points");
  EXPECT_EQ(by_points.exit_code, 2);
  EXPECT_NE(by_points.err.find("--static-points alone works with any masks"), std::string::npos)
      << by_points.err;
  EXPECT_EQ(test::run_penumbra(masks + "--static-points adaptive").exit_code, 0);
}

TEST(SlamCommand, WritesEverythingAndRepeatsBitForBit) {
  PENUMBRA_REAL_DATA(kitti, "kitti");
  const test::TemporaryDirectory folder;
  for (const char* out : {"first", "second"}) {
    const test::ProgramResult result =
        test::run_penumbra(fmt::format("slam '{}' --sequence 06 --frames 5:25 --out '{}' --deterministic",
                                       kitti.string(), (folder / out).string()));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("20 frames, 20 tracked, 0 lost"), std::string::npos) << result.out;
  }
  for (const char* file : {"trajectory_kitti.txt", "trajectory_tum.txt", "map.ply", "trajectory.svg"}) {
    ASSERT_FALSE(contents(folder / "first" / file).empty()) << file;
    EXPECT_EQ(contents(folder / "first" / file), contents(folder / "second" / file)) << file;
  }
  const nlohmann::json report = nlohmann::json::parse(contents(folder / "first" / "run.json"));
  EXPECT_EQ(report["frames"], 20);
  EXPECT_EQ(report["tracked"], 20);
  EXPECT_EQ(report["lost"], 0);
  EXPECT_GT(report["keyframes"], 1);
  EXPECT_GT(report["map_points"], 500);
  for (const char* key : {"median_ms", "p95_ms", "stages", "processor_ms", "settings"})
    EXPECT_TRUE(report.contains(key)) << key;
  EXPECT_LT(report["ground_truth"]["ape_rmse_m"], 0.5);
}

// The disparities of this recording are about 0.15 pixels too small for its calibration.
TEST(SlamCommand, FindsTheDisparityOffsetUnlessToldNotTo) {
  PENUMBRA_REAL_DATA(kitti, "kitti");
  const test::TemporaryDirectory folder;
  const auto run = [&](const std::string& option) {
    const test::ProgramResult result = test::run_penumbra(fmt::format(
        "slam '{}' --sequence 06 --out '{}' --segmentation off --deterministic --self-calibration {}",
        kitti.string(), folder.path().string(), option));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out.find("too small for the calibration") != std::string::npos, option == "on")
        << result.out;
    return nlohmann::json::parse(contents(folder / "run.json"));
  };
  const nlohmann::json on = run("on"), off = run("off");
  EXPECT_NEAR(on["disparity_offset_px"].get<double>(), -0.15, 0.05);
  EXPECT_EQ(on["settings"]["self_calibration"], true);
  EXPECT_EQ(off["disparity_offset_px"], 0.0);
  EXPECT_LT(on["ground_truth"]["ape_rmse_m"].get<double>(),
            0.7 * off["ground_truth"]["ape_rmse_m"].get<double>());
}

TEST(SlamCommand, KeepsWhatAStrictRunComputedBeforeATornImage) {
  PENUMBRA_REAL_DATA(kitti, "kitti/sequences/06");
  const test::TemporaryDirectory folder;
  const std::filesystem::path copy = folder / "sequence";
  std::filesystem::create_directories(copy / "image_0");
  std::filesystem::create_directories(copy / "image_1");
  for (const char* file : {"calib.txt", "times.txt"}) std::filesystem::copy(kitti / file, copy / file);
  for (int i = 0; i < 8; ++i) {
    const std::string name = fmt::format("{:06}.png", i);
    for (const char* side : {"image_0", "image_1"}) {
      std::filesystem::copy(kitti / side / name, copy / side / name);
    }
  }
  const std::filesystem::path torn = copy / "image_1/000005.png";
  std::filesystem::resize_file(torn, std::filesystem::file_size(torn) / 2);
  const test::ProgramResult result = test::run_penumbra(
      fmt::format("slam '{}' --strict --out '{}'", copy.string(), (folder / "out").string()));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("000005.png"), std::string::npos) << result.err;
  const nlohmann::json report = nlohmann::json::parse(contents(folder / "out" / "run.json"));
  EXPECT_EQ(report["frames"], 5);
  EXPECT_NE(report["error"].get<std::string>().find("000005.png"), std::string::npos);
  const std::string poses = contents(folder / "out" / "trajectory_kitti.txt");
  EXPECT_EQ(std::count(poses.begin(), poses.end(), '\n'), 5);
}

// Two drives along one street: in the second the light is another and other cars pass.
TEST(SlamCommand, FindsItsWayInASavedMapAndGoesOnWithIt) {
  const test::TemporaryDirectory folder;
  const std::string root = folder.path().string();
  const auto run = [&](const std::string& arguments) {
    const test::ProgramResult result = test::run_penumbra(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << result.err;
    return result;
  };
  const auto report = [&](const char* out) {
    return nlohmann::json::parse(contents(folder / out / "run.json"));
  };
  run(fmt::format("synth --frames 24 --size 310x94 --out {}/first", root));
  run(fmt::format("synth --frames 24 --size 310x94 --traffic 4 --light overcast --noise 3 --out {}/second",
                  root));
  run(fmt::format("slam {0}/first --frames 0:18 --deterministic --save-map {0}/street.map --out {0}/a",
                  root));
  const std::string saved = contents(folder / "street.map");

  run(fmt::format(
      "slam {0}/second --frames 2:16 --deterministic --load-map {0}/street.map --localise --out {0}/b",
      root));
  EXPECT_EQ(report("b")["tracked"], 14);
  EXPECT_EQ(report("b")["keyframes"], 0);
  EXPECT_EQ(report("b")["loaded_keyframes"], report("a")["keyframes"]);
  EXPECT_LT(report("b")["ground_truth"]["ape_rmse_m"], 0.1);
  EXPECT_EQ(contents(folder / "street.map"), saved);

  run(fmt::format(
      "slam {0}/second --frames 6:24 --deterministic --load-map {0}/street.map --save-map {0}/longer.map "
      "--out {0}/c",
      root));
  EXPECT_EQ(report("c")["tracked"], 18);
  EXPECT_GT(report("c")["keyframes"], 0);
  EXPECT_GT(report("c")["loaded_keyframes"], 0);
  EXPECT_GT(contents(folder / "longer.map").size(), saved.size());
  const test::ProgramResult merge = test::run_penumbra(
      fmt::format("merge {0}/street.map {0}/longer.map -o {0}/nowhere/x.map --out {0}/merged", root));
  EXPECT_EQ(merge.exit_code, 1);
  EXPECT_NE(merge.err.find("nowhere: expected a folder for the map"), std::string::npos) << merge.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "merged")) << "refused before anything is merged";

  // Another camera's, a torn one, none, nowhere to write.
  const auto refused = [&](const std::string& options, int exit_code, const char* what) {
    const test::ProgramResult result =
        test::run_penumbra(fmt::format("slam {0}/first --frames 0:3 --out {0}/refused {1}", root, options));
    EXPECT_EQ(result.exit_code, exit_code) << options;
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "refused"));
  };
  std::filesystem::resize_file(folder / "longer.map", 1000);
  refused(fmt::format("--load-map {}/longer.map", root), 1, "torn");
  refused(fmt::format("--load-map {}/none.map", root), 1, "none.map");
  refused("--localise", 2, "--load-map");
  refused(fmt::format("--localise --load-map {0}/street.map --save-map {0}/x.map", root), 2, "--save-map");
  refused(fmt::format("--save-map {}/nowhere/x.map", root), 1, "nowhere");
  run(fmt::format("synth --frames 2 --size 200x94 --out {}/other", root));
  const test::ProgramResult other =
      test::run_penumbra(fmt::format("slam {0}/other --load-map {0}/street.map --out {0}/refused", root));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.err.find("a map of the dataset's camera"), std::string::npos) << other.err;
}

}  // namespace
}  // namespace penumbra
