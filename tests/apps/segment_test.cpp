// penumbra segment, from the command line.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "nn/io/coco_rle.h"
#include "nn/io/image_file.h"
#include "nn/io/safetensors.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

// A folder with random weights and an image.
class SegmentTest : public ::testing::Test {
 protected:
  void SetUp() override {
    nn::write_safetensors(weights(), random_mask_rcnn(false));
    nn::write_image(folder_ / "0042.png", random_image(1, 96, 64));
  }
  std::string weights() const { return folder_ / "weights.safetensors"; }
  std::string image() const { return folder_ / "0042.png"; }
  std::string out() const { return folder_ / "out"; }
  ProgramResult segment(const std::string& arguments) const {
    return run_penumbra("segment " + arguments + " --min-size 128 --max-size 224 --out " + out());
  }
  TemporaryDirectory folder_;
};

TEST_F(SegmentTest, WritesAPictureAndCocoResults) {
  const ProgramResult result = segment(image() + " --weights " + weights());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nn::read_image(std::filesystem::path(out()) / "0042_overlay.png", nn::ImageColour::bgr).cols,
            640);

  std::ifstream file(std::filesystem::path(out()) / "results.json");
  const nlohmann::json results = nlohmann::json::parse(file);
  ASSERT_EQ(results.size(), 100U);
  const nlohmann::json& first = results[0];
  EXPECT_EQ(first["image_id"], 42);
  EXPECT_NEAR(first["score"].get<double>(), 0.9149, 1e-3);
  EXPECT_EQ(first["segmentation"]["size"], (std::vector{64, 96}));
  EXPECT_NO_THROW(nn::decode_runs(first["segmentation"]["counts"].get<std::string>(), 64 * 96));
}

TEST_F(SegmentTest, ClassNamesComeFromAFile) {
  std::ofstream names(folder_ / "names.txt");
  for (int c = 1; c < 91; ++c) names << "thing-" << c << "\n";
  names.close();
  const ProgramResult result =
      segment(image() + " --weights " + weights() + " --classes " + (folder_ / "names.txt").string());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("thing-"), std::string::npos);

  std::ofstream(folder_ / "names.txt") << "car\n";
  const ProgramResult wrong =
      segment(image() + " --weights " + weights() + " --classes " + (folder_ / "names.txt").string());
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.err.find("expected 91 class names"), std::string::npos) << wrong.err;
}

TEST_F(SegmentTest, ATornImageIsNamedAndTheOthersAreStillDone) {
  std::ofstream(folder_ / "torn.png") << "\x89PNG\r\n\x1a\n";
  const ProgramResult result =
      segment((folder_ / "torn.png").string() + " " + image() + " --weights " + weights());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("torn.png"), std::string::npos) << result.err;
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out()) / "0042_overlay.png"));
}

TEST_F(SegmentTest, WeightsThatAreMissingOrOfAnotherNetworkAreAnError) {
  EXPECT_EQ(segment(image() + " --weights /no/such/file").exit_code, 1);
  nn::StateDict weights_of_nothing;
  const float one = 1.0F;
  weights_of_nothing.tensors["a"] = {nn::DataType::f32, {1}, std::as_bytes(std::span(&one, 1))};
  nn::write_safetensors(weights(), weights_of_nothing);
  const ProgramResult result = segment(image() + " --weights " + weights());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("missing backbone.body.conv1.weight"), std::string::npos) << result.err;
}

TEST_F(SegmentTest, WrongArgumentsGiveExitCode2) {
  EXPECT_EQ(run_penumbra("segment " + image()).exit_code, 2);
  EXPECT_EQ(segment(image() + " --weights " + weights() + " --isa vax").exit_code, 2);
  EXPECT_EQ(segment(image() + " --weights " + weights() + " --threads 0").exit_code, 2);
  EXPECT_EQ(segment(image() + " " + image() + " --weights " + weights()).exit_code, 2);
}

}  // namespace
}  // namespace penumbra::test
