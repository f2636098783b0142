// penumbra classify, and segment with YOLOv5, from the command line.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

class ClassifyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    nn::write_safetensors(weights(), random_resnet(18, 8));
    nn::write_image(image(), random_image(1, 96, 64));
  }
  std::string weights() const { return folder_ / "weights.safetensors"; }
  std::string image() const { return folder_ / "42.png"; }
  TemporaryDirectory folder_;
};

TEST_F(ClassifyTest, PrintsTheBestClassesAsTextAndAsJson) {
  const ProgramResult text = run_penumbra("classify " + image() + " --weights " + weights() + " --top 2");
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_NE(text.out.find("class "), std::string::npos) << text.out;
  EXPECT_EQ(std::count(text.out.begin(), text.out.end(), '\n'), 3);

  const ProgramResult result =
      run_penumbra("classify " + image() + " --weights " + weights() + " --top 99 --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json top = nlohmann::json::parse(result.out)[0]["top"];
  ASSERT_EQ(top.size(), 10U);
  double sum = 0.0;
  for (std::size_t i = 0; i < top.size(); ++i) {
    sum += top[i]["probability"].get<double>();
    if (i > 0) {
      EXPECT_GE(top[i - 1]["logit"], top[i]["logit"]);
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-5);
}

TEST_F(ClassifyTest, ClassNamesComeFromAFileOfOneNameAnOutput) {
  const std::string file = folder_ / "names.txt";
  std::ofstream names(file);
  for (int c = 0; c < 10; ++c) names << "bird-" << c << "\n";
  names.close();
  const std::string command = "classify " + image() + " --weights " + weights() + " --classes " + file;
  EXPECT_NE(run_penumbra(command).out.find("bird-"), std::string::npos);
  std::ofstream(file) << "bird\n";
  const ProgramResult wrong = run_penumbra(command);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.err.find("expected 10 class names, found 1"), std::string::npos) << wrong.err;
}

TEST_F(ClassifyTest, ATornImageIsNamedAndTheOthersAreStillDone) {
  std::ofstream(folder_ / "torn.png") << "\x89PNG\r\n\x1a\n";
  const ProgramResult result = run_penumbra("classify " + (folder_ / "torn.png").string() + " " + image() +
                                            " --weights " + weights() + " --json");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("torn.png"), std::string::npos) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).size(), 1U);
}

TEST_F(ClassifyTest, WrongArgumentsGiveExitCode2AndWrongWeights1) {
  EXPECT_EQ(run_penumbra("classify " + image()).exit_code, 2);
  EXPECT_EQ(run_penumbra("classify " + image() + " --weights " + weights() + " --top 0").exit_code, 2);
  nn::write_safetensors(weights(), random_yolov5({}));
  const ProgramResult result = run_penumbra("classify " + image() + " --weights " + weights());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("missing conv1.weight"), std::string::npos) << result.err;
}

TEST_F(ClassifyTest, SegmentTakesYolov5WithAndWithoutMasks) {
  for (const bool masks : {true, false}) {
    nn::write_safetensors(weights(), random_yolov5({0.125, 1.0 / 3.0, 80, masks, true}));
    const std::string out = folder_ / "out";
    const ProgramResult result = run_penumbra("segment " + image() + " --weights " + weights() +
                                              " --max-size 96 --score-threshold 0.2 --out " + out);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::ifstream file(out + "/results.json");
    const nlohmann::json results = nlohmann::json::parse(file);
    ASSERT_FALSE(results.empty());
    for (const nlohmann::json& entry : results) EXPECT_LE(entry["category_id"], 90);
  }
}

}  // namespace
}  // namespace penumbra::test
