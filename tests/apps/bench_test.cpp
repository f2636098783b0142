// penumbra bench, calibrate and info --cpu: what they print, not how fast they are.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/io/image_file.h"
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

TEST(Bench, WrongArgumentsAreUsageErrors) {
  for (const char* arguments :
       {"bench", "bench speed", "bench conv --shape 32", "bench conv --shape 0,1,2x2,1,1",
        "bench network --size 96", "bench peak --repeats 0", "bench peak --isa mmx",
        "bench network --precision fp16", "info", "info --cpu file"}) {
    EXPECT_EQ(test::run_penumbra(arguments).exit_code, 2) << arguments;
  }
}

TEST(Info, CpuNamesTheInstructionSetInUse) {
  EXPECT_EQ(json_of("info --cpu --isa baseline --json")["isa"], "baseline");
  EXPECT_NE(test::run_penumbra("info --cpu").out.find("instruction set"), std::string::npos);
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

}  // namespace
}  // namespace penumbra
