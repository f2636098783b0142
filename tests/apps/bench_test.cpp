// penumbra bench, calibrate and info --cpu: what they print, not how fast they are.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "nn/simd/low_precision.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

nlohmann::json json_of(const std::string& arguments) {
  const test::ProgramResult result = test::run_penumbra(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

TEST(Bench, PeakIsMeasuredForTheInstructionSetAndThreadsAskedFor) {
  const nlohmann::json peak = json_of("bench peak --isa baseline --threads 1 --repeats 1 --warm-up 0 --json");
  EXPECT_EQ(peak["isa"], "baseline");
  EXPECT_EQ(peak["threads"], 1);
  EXPECT_GT(peak["peak_gflops"], 0.0);
}

TEST(Bench, ConvCountsTheDirectConvolution) {
  const nlohmann::json result = json_of("bench conv --shape 32,64,20x10,3,1 --repeats 1 --json");
  const nlohmann::json& layer = result["layers"].at(0);
  EXPECT_EQ(layer["algorithm"], "winograd");
  EXPECT_NEAR(layer["gflop"], 2e-9 * 32 * 64 * 20 * 10 * 9, 1e-12);
  EXPECT_GT(layer["share_of_peak"], 0.0);
  EXPECT_GT(layer["mb_moved"], 0.0);
}

TEST(Bench, ConvRunsInSmallNumbersOnTiles) {
  for (const char* precision : {"bf16", "int8"}) {
    const nlohmann::json result = json_of(
        fmt::format("bench conv --shape 32,64,20x10,3,1 --isa amx-emulated --precision {} --repeats 1 "
                    "--warm-up 0 --threads 1 --json",
                    precision));
    EXPECT_EQ(result["precision"], precision);
    EXPECT_EQ(result["layers"].at(0)["algorithm"], "tiles");
    EXPECT_GT(result["peak_tile_gflops"][precision], 0.0);
  }
}

TEST(Bench, NetworkPrintsOneObject) {
  const nlohmann::json result =
      json_of("bench network --size 96x64 --min-size 64 --detections 5 --repeats 1 --warm-up 0 --json");
  for (const char* key : {"isa", "threads", "peak_gflops", "backbone_fpn_seconds", "full_seconds",
                          "backbone_fpn_gflop", "arena_mb", "precision", "detections"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  EXPECT_EQ(result["detections"], 5);
  EXPECT_GT(result["backbone_fpn_gflop"], 1.0);
}

TEST(Bench, DetectorsAreComparedWithTheFirst) {
  const std::string weights =
      test::source_path("weights_tools/models/penumbra-office.safetensors").string() + " ";
  const nlohmann::json result = json_of("bench detectors " + weights + weights +
                                        "--size 64x48 --max-size 64 --repeats 2 --warm-up 1 --json");
  ASSERT_EQ(result["networks"].size(), 2U);
  EXPECT_EQ(result["networks"][1]["network"], "YOLOv5n");
  EXPECT_EQ(result["networks"][0]["median_ratio"], 1.0);
  EXPECT_GT(result["networks"][1]["processor_ms"], 0.0);
}

TEST(Bench, ImageOperationsAreTimedOneByOne) {
  const nlohmann::json result =
      json_of("bench image --size 64x48 --isa baseline --repeats 1 --warm-up 0 --json");
  EXPECT_EQ(result["isa"], "baseline");
  EXPECT_EQ(result["width"], 64);
  ASSERT_GE(result["operations"].size(), 10U);
  for (const nlohmann::json& operation : result["operations"])
    EXPECT_GT(operation["megapixels_per_second"], 0.0) << operation["name"];
}

TEST(Bench, WrongArgumentsAreUsageErrors) {
  for (const char* arguments :
       {"bench", "bench speed", "bench conv --shape 32", "bench conv --shape 0,1,2x2,1,1",
        "bench network --size 96", "bench image --size 8x8", "bench image --size x", "bench peak --repeats 0",
        "bench peak --isa mmx", "bench network --precision fp16", "info", "info --cpu file"}) {
    EXPECT_EQ(test::run_penumbra(arguments).exit_code, 2) << arguments;
  }
}

TEST(Info, CpuNamesTheInstructionSetInUse) {
  EXPECT_EQ(json_of("info --cpu --isa baseline --json")["isa"], "baseline");
  EXPECT_NE(test::run_penumbra("info --cpu").out.find("instruction set"), std::string::npos);
}

TEST(Info, CpuSaysHowSmallNumbersAreMultiplied) {
  const nlohmann::json emulated = json_of("info --cpu --isa amx-emulated --json");
  EXPECT_EQ(emulated["isa"], "amx-emulated");
  EXPECT_EQ(emulated["bf16"], "tile products");
  EXPECT_EQ(emulated["precision_auto"], "bf16");
  const nlohmann::json baseline = json_of("info --cpu --isa baseline --json");
  EXPECT_EQ(baseline["bf16"], "none");
  EXPECT_EQ(baseline["precision_auto"], "f32");
  EXPECT_EQ(baseline["amx"] == "yes", nn::is_supported(nn::Isa::amx));
  if (!nn::is_supported(nn::Isa::amx)) {
    const test::ProgramResult refused = test::run_penumbra("info --cpu --isa amx");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find(baseline["amx"].get<std::string>()), std::string::npos) << refused.err;
  }
}

TEST(Calibrate, MakesWeightsThatRunInInt8) {
  const test::TemporaryDirectory folder;
  const std::string weights = (folder / "yolo.safetensors").string(), image = (folder / "image.png").string();
  nn::write_safetensors(weights, test::random_yolov5({0.25, 1.0 / 3.0, 4, true, false}));
  nn::write_image(image, test::random_image(1, 120, 90));

  const std::string calibrated = (folder / "int8.safetensors").string();
  const test::ProgramResult result =
      test::run_penumbra("calibrate " + image + " --weights " + weights + " -o " + calibrated);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nn::StateDict state = nn::read_safetensors(calibrated);
  EXPECT_TRUE(state.metadata.contains("input_range.model.1"));
  EXPECT_EQ(test::run_penumbra("calibrate " + image + " --weights " + weights + " -o " + weights).exit_code,
            2);
  EXPECT_EQ(test::run_penumbra("calibrate missing.png --weights " + weights + " -o " + calibrated).exit_code,
            1);

  if (!nn::is_supported(nn::Precision::int8)) GTEST_SKIP() << "no int8 here";
  const std::string segment = "segment " + image + " --max-size 128 --precision int8 --out " +
                              (folder / "out").string() + " --weights ";
  EXPECT_EQ(test::run_penumbra(segment + calibrated).exit_code, 0);
  const test::ProgramResult uncalibrated = test::run_penumbra(segment + weights);
  EXPECT_EQ(uncalibrated.exit_code, 1);
  EXPECT_NE(uncalibrated.err.find("penumbra calibrate"), std::string::npos) << uncalibrated.err;
  EXPECT_EQ(test::run_penumbra(segment + calibrated + " --isa avx2").exit_code, 2);
}

// A folder with two recordings and something else, and the streets.
TEST(Bench, SlamRunsEverythingInAFolder) {
  const test::TemporaryDirectory folder;
  const std::string root = folder.path().string();
  for (const char* where : {"data/kitti", "data/own/away", "data/other/away"}) {
    ASSERT_EQ(
        test::run_penumbra(fmt::format("synth --frames 3 --size 200x80 --out {}/{}", root, where)).exit_code,
        0);
  }
  std::filesystem::create_directories(folder / "data/photos");
  const std::string command =
      fmt::format("bench slam {0}/data --streets {0}/streets --street-frames 3 --out {0}/out", root);
  const nlohmann::json result = json_of(command + " --deterministic --json");
  ASSERT_EQ(result["runs"].size(), 5U);
  std::vector<std::string> names;
  for (const nlohmann::json& run : result["runs"]) {
    names.push_back(run["name"]);
    EXPECT_EQ(run["frames"], 3);
    EXPECT_EQ(run["lost"], 0);
    EXPECT_EQ(run["loops"], 0);
    EXPECT_LT(run["ate_m"], 0.5);
    for (const char* key : {"keyframes", "median_ms", "p95_ms", "cpu_ms_per_frame", "peak_rss_mb"}) {
      EXPECT_GT(run[key], 0.0) << key;
    }
  }
  // Two recordings of one name are two rows and two folders.
  EXPECT_EQ(names, (std::vector<std::string>{"kitti/00", "other/away/00", "own/away/00", "street-block-3",
                                             "street-eight-3"}));
  for (const std::string& name : names)
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name / "run.json"));
  EXPECT_EQ(test::read_json(folder / "out/table.json"), result);

  // A recording that cannot be read is a row that says so, and the others are run all the same.
  std::filesystem::resize_file(folder / "data/kitti/sequences/00/calib.txt", 100);
  const test::ProgramResult torn = test::run_penumbra(fmt::format("bench slam {0}/data --out {0}/out", root));
  EXPECT_EQ(torn.exit_code, 1);
  EXPECT_NE(torn.out.find("failed"), std::string::npos) << torn.out;
  EXPECT_NE(torn.out.find("away/00"), std::string::npos);
  EXPECT_NE(torn.err.find("calib.txt"), std::string::npos) << torn.err;

  EXPECT_EQ(test::run_penumbra("bench slam --out " + root).exit_code, 2);
  EXPECT_EQ(test::run_penumbra(fmt::format("bench slam {0}/data/photos --out {0}/out", root)).exit_code, 1);
}

}  // namespace
}  // namespace penumbra
