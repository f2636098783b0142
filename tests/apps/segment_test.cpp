// penumbra segment, from the command line.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>

#include "nn/evaluation/coco_rle.h"
#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "tests/support/bytes.h"
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
  EXPECT_EQ(nn::read_image(std::filesystem::path(out()) / "0042_overlay.png", nn::ImageColour::bgr).width(),
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

// Earlier results may be complete: those of a run with unreadable images do not take their place.
TEST_F(SegmentTest, AnUnreadableImageDoesNotReplaceGoodResults) {
  const std::filesystem::path out_folder = out();
  const std::string torn = folder_ / "torn.png";
  std::ofstream(torn) << "\x89PNG\r\n\x1a\n";
  EXPECT_EQ(segment(torn + " --weights " + weights()).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(out_folder / "results.json"));
  ASSERT_EQ(segment(image() + " --weights " + weights()).exit_code, 0);
  const std::string good = read_file(out_folder / "results.json");
  const ProgramResult result =
      segment(torn + " " + image() + " --weights " + weights() + " --score-threshold 0.9");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("torn.png"), std::string::npos) << result.err;
  EXPECT_EQ(read_file(out_folder / "results.json"), good);
  EXPECT_TRUE(read_json(out_folder / "results_partial.json").is_array());
}

TEST_F(SegmentTest, FoldersAreTakenInTheOrderOfTheirNumbersWithoutTheDesktopsFiles) {
  const std::filesystem::path images = folder_ / "images";
  std::filesystem::create_directory(images);
  for (const char* name : {"2.png", "10.png"}) nn::write_image(images / name, random_image(1, 32, 24));
  std::filesystem::rename(images / "10.png", images / "10.PNG");
  for (const char* name : {"._2.png", ".DS_Store", "Thumbs.db", "notes.txt"}) write_file(images / name, "x");
  const ProgramResult result =
      segment(images.string() + " " + (images / "._2.png").string() + " --weights " + weights() + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json found = nlohmann::json::parse(result.out)["images"];
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]["path"], (images / "2.png").string());
  EXPECT_EQ(found[1]["path"], (images / "10.PNG").string());
}

TEST_F(SegmentTest, PhotographsAreTurnedUprightUnlessToldOtherwise) {
  // 60 x 40 pixels that are to be turned by 90 degrees.
  const std::string photograph = fixture("images/turned.jpg").string();
  const auto size = [&](const std::string& options) {
    const ProgramResult result = segment(photograph + " --weights " + weights() + " --json" + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json found = nlohmann::json::parse(result.out)["images"][0];
    return std::pair(found["width"].get<int>(), found["height"].get<int>());
  };
  EXPECT_EQ(size(""), std::pair(40, 60));
  EXPECT_EQ(size(" --ignore-exif"), std::pair(60, 40));
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

TEST_F(SegmentTest, PrintsJsonForMachines) {
  const ProgramResult result = segment(image() + " --weights " + weights() + " --json --threads 2");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["threads"], 2);
  EXPECT_TRUE(report["isa"].is_string());
  EXPECT_GT(report["peak_arena_bytes"], 1000000);
  ASSERT_EQ(report["images"].size(), 1U);
  const nlohmann::json& first = report["images"][0];
  EXPECT_EQ(first["width"], 96);
  EXPECT_EQ(first["height"], 64);
  EXPECT_EQ(first["instances"], 100);
  EXPECT_GT(first["seconds"], 0.0);
  ASSERT_FALSE(first["shown"].empty());
  EXPECT_GE(first["shown"][0]["score"], 0.5);
  EXPECT_EQ(first["shown"][0]["box"].size(), 4U);
}

// Two images of a data set whose categories are numbered otherwise than the network's classes.
class SegmentSetTest : public SegmentTest {
 protected:
  void SetUp() override {
    SegmentTest::SetUp();
    nn::write_image(folder_ / "b.png", random_image(2, 80, 60));
    set_ = {{"images",
             {{{"id", 7}, {"width", 96}, {"height", 64}, {"file_name", "0042.png"}},
              {{"id", 5}, {"width", 80}, {"height", 60}, {"file_name", "b.png"}}}},
            {"categories", nlohmann::json::array()},
            {"annotations", nlohmann::json::array()}};
    std::ofstream names(folder_ / "names.txt");
    for (int c = 1; c < 91; ++c) {
      names << "thing-" << c << "\n";
      if (c % 2 == 0)
        set_["categories"].push_back({{"id", 1000 + c}, {"name", "thing-" + std::to_string(c)}});
    }
  }
  std::string annotations() const { return folder_ / "instances.json"; }
  ProgramResult segment_set(const std::string& more = "") const {
    std::ofstream(annotations()) << set_;
    return segment("--coco-images " + folder_.path().string() + " --annotations " + annotations() +
                   " --weights " + weights() + " --classes " + (folder_ / "names.txt").string() + " " + more);
  }
  nlohmann::json set_;
};

TEST_F(SegmentSetTest, WritesResultsThatCanBeEvaluated) {
  const ProgramResult result = segment_set();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("2 images, 200 instances"), std::string::npos) << result.out;
  EXPECT_NE(result.err.find("instances of classes that"), std::string::npos)
      << result.err;  // the odd classes
  const std::filesystem::path results = std::filesystem::path(out()) / "results.json";
  std::ifstream file(results);
  std::set<int> images;
  for (const auto& entry : nlohmann::json::parse(file)) {
    images.insert(entry["image_id"].get<int>());
    EXPECT_GT(entry["category_id"], 1000);
    EXPECT_EQ(entry["category_id"].get<int>() % 2, 0);
  }
  EXPECT_EQ(images, (std::set<int>{5, 7}));
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(out()) / "b_overlay.png"));
  const ProgramResult evaluation =
      run_penumbra("eval-coco --annotations " + annotations() + " --results " + results.string());
  EXPECT_EQ(evaluation.exit_code, 0) << evaluation.err;
}

TEST_F(SegmentSetTest, PrintsJsonAndDrawsPicturesOnDemand) {
  const ProgramResult result = segment_set("--json --pictures");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["instances"], 200);
  EXPECT_EQ(report["images"][1]["width"], 80);
  EXPECT_FALSE(report["images"][1].contains("shown"));
  EXPECT_TRUE(std::filesystem::exists(report["images"][1]["picture"].get<std::string>()));
}

TEST_F(SegmentSetTest, ImagesThatAreMissingOrOfAnotherSizeAreNamedAndTheOthersStillDone) {
  set_["images"][0]["width"] = 100;
  set_["images"].push_back({{"id", 9}, {"width", 8}, {"height", 8}, {"file_name", "none.png"}});
  const ProgramResult result = segment_set("--json");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("expected 100 x 64 pixels as in the annotations, found 96 x 64"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("none.png"), std::string::npos) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["images"].size(), 1U);
  EXPECT_EQ(report["failed"].size(), 2U);
}

TEST_F(SegmentSetTest, ClassesWithoutAnyCategoryAreAnError) {
  set_["categories"] = {{{"id", 1}, {"name", "person"}}};
  const ProgramResult result = segment_set();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("instances.json: expected categories named as the network's classes"),
            std::string::npos)
      << result.err;
}

TEST_F(SegmentTest, WrongArgumentsGiveExitCode2) {
  EXPECT_EQ(segment("--weights " + weights()).exit_code, 2);
  EXPECT_EQ(segment("--weights " + weights() + " --coco-images " + out()).exit_code, 2);
  EXPECT_EQ(segment(image() + " --weights " + weights() + " --pictures").exit_code, 2);
  EXPECT_EQ(
      segment(image() + " --weights " + weights() + " --coco-images x --annotations " + image()).exit_code,
      2);
  EXPECT_EQ(run_penumbra("segment " + image()).exit_code, 2);
  EXPECT_EQ(segment(image() + " --weights " + weights() + " --isa vax").exit_code, 2);
  EXPECT_EQ(segment(image() + " --weights " + weights() + " --threads 0").exit_code, 2);
  EXPECT_EQ(segment(image() + " " + image() + " --weights " + weights()).exit_code, 2);
}

}  // namespace
}  // namespace penumbra::test
