// penumbra synth: the layout it writes and how it refuses.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "slam/sources/open_dataset.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

int lines_in(const std::filesystem::path& path) {
  std::ifstream file(path);
  return static_cast<int>(std::count(std::istreambuf_iterator<char>(file), {}, '\n'));
}

TEST(Synth, WritesTheNumbersOfThingsInBothLayouts) {
  const TemporaryDirectory folder;
  for (const std::string sensor : {"stereo", "rgbd"}) {
    const std::string out = (folder / sensor).string();
    const ProgramResult result = run_penumbra(
        "synth --frames 2 --size 310x94 --landmarks --lamps 10 --sensor " + sensor + " --out " + out);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const bool stereo = sensor == "stereo";
    const std::filesystem::path root = stereo ? folder / "stereo/sequences/00" : folder / "rgbd";
    const nlohmann::json things = nlohmann::json::parse(std::ifstream(root / "landmarks.json"));
    const cv::Mat image = cv::imread((root / "landmarks" / (stereo ? "000001.png" : "0.100000.png")).string(),
                                     cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.size(), cv::Size(310, 94));
    EXPECT_EQ(image.type(), CV_16UC1);
    std::set<std::string> classes;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const int number = image.at<std::uint16_t>(y, x);
        if (number != 0) classes.insert(things.at(std::to_string(number)).at("class").get<std::string>());
      }
    }
    for (const char* name : {"facade", "plant", "lamp"}) EXPECT_TRUE(classes.contains(name)) << name;
  }
}

TEST(Synth, WritesTheKittiLayout) {
  const TemporaryDirectory folder;
  const std::string out = (folder / "street").string();
  const ProgramResult result = run_penumbra("synth --frames 3 --size 310x94 --colour --depth --out " + out);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.err.empty()) << "no progress bar without a terminal: " << result.err;

  const std::filesystem::path sequence = folder / "street/sequences/00";
  for (const char* images : {"image_0", "image_1", "image_2", "image_3", "instances", "depth"}) {
    for (const char* name : {"000000.png", "000001.png", "000002.png"}) {
      const cv::Mat image = cv::imread((sequence / images / name).string(), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(image.size(), cv::Size(310, 94)) << images << "/" << name;
      const std::string kind = images;
      const int type = kind == "instances" || kind == "depth"   ? CV_16UC1
                       : kind == "image_2" || kind == "image_3" ? CV_8UC3
                                                                : CV_8UC1;
      EXPECT_EQ(image.type(), type) << images;
    }
  }
  EXPECT_EQ(lines_in(sequence / "times.txt"), 3);
  EXPECT_EQ(lines_in(folder / "street/poses/00.txt"), 3);
  EXPECT_EQ(lines_in(sequence / "calib.txt"), 4);
  EXPECT_EQ(slam::open_dataset(folder / "street")->name(), "synthetic street, block, seed 1");

  // The first pose is the identity, P1 holds the baseline.
  std::ifstream poses(folder / "street/poses/00.txt");
  for (int i = 0; i < 12; ++i) {
    double value = 0.0;
    poses >> value;
    EXPECT_NEAR(value, i % 5 == 0 ? 1.0 : 0.0, 1e-9);
  }
  std::ifstream calibration(sequence / "calib.txt");
  std::string line, name;
  std::getline(calibration, line);
  double p1[12];
  calibration >> name;
  for (double& value : p1) calibration >> value;
  EXPECT_EQ(name, "P1:");
  EXPECT_NEAR(-p1[3] / p1[0], 0.537, 1e-9);

  // Every id of the masks is explained.
  const auto instances = nlohmann::json::parse(std::ifstream(sequence / "instances.json"));
  const cv::Mat1w mask = cv::imread((sequence / "instances/000000.png").string(), cv::IMREAD_UNCHANGED);
  std::set<int> ids(mask.begin(), mask.end());
  EXPECT_GT(ids.size(), 2U);
  for (const int id : ids) {
    if (id == 0) continue;
    const auto& entry = instances.at(std::to_string(id));
    const std::set<std::string> classes{"person", "cyclist", "car", "truck", "sign"};
    EXPECT_EQ(classes.count(entry.at("class")), 1U) << entry;
    EXPECT_TRUE(entry.at("moving").is_boolean());
  }
}

TEST(Synth, WritesAnnotationsThatTheEvaluationReads) {
  const TemporaryDirectory folder;
  const std::string out = (folder / "street").string();
  const ProgramResult result =
      run_penumbra("synth --preset crowded --frames 3 --annotations --colour --out " + out);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::filesystem::path file = folder / "street/annotations/instances.json";
  const auto coco = nlohmann::json::parse(std::ifstream(file));
  ASSERT_EQ(coco.at("images").size(), 3U);
  EXPECT_EQ(coco.at("images")[2].at("file_name"), "sequences/00/image_2/000002.png");
  EXPECT_TRUE(std::filesystem::exists(folder / "street/sequences/00/image_2/000002.png"));
  ASSERT_EQ(coco.at("categories").size(), 5U);
  EXPECT_EQ(coco.at("categories")[3].at("name"), "truck");
  ASSERT_GT(coco.at("annotations").size(), 15U);

  // The ground truth as its own detections scores 100.
  auto results = nlohmann::json::array();
  for (const auto& entry : coco.at("annotations")) {
    EXPECT_GE(entry.at("area"), 20);
    EXPECT_EQ(entry.at("iscrowd"), 0);
    EXPECT_GE(entry.at("occlusion"), 0.0);
    EXPECT_LT(entry.at("occlusion"), 1.0);
    EXPECT_TRUE(entry.at("moving").is_boolean());
    EXPECT_TRUE(entry.at("amodal_segmentation").at("counts").is_string());
    results.push_back({{"image_id", entry.at("image_id")},
                       {"category_id", entry.at("category_id")},
                       {"bbox", entry.at("bbox")},
                       {"segmentation", entry.at("segmentation")},
                       {"score", 0.9}});
  }
  std::ofstream(folder / "results.json") << results;
  const ProgramResult scored = run_penumbra("eval-coco --json --annotations " + file.string() +
                                            " --results " + (folder / "results.json").string());
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const auto scores = nlohmann::json::parse(scored.out);
  EXPECT_NEAR(scores.at("bbox").at("AP").get<double>(), 1.0, 1e-9) << scores;
  EXPECT_NEAR(scores.at("segm").at("AP").get<double>(), 1.0, 1e-9) << scores;
}

TEST(Synth, RefusesAFolderWithFilesUnlessToldToOverwrite) {
  const TemporaryDirectory folder;
  const std::string arguments = "synth --size 64x32 --out " + folder.path().string();
  std::ofstream(folder / "notes.txt") << "keep me";
  const ProgramResult refused = run_penumbra(arguments + " --frames 2");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("--overwrite"), std::string::npos) << refused.err;
  EXPECT_EQ(run_penumbra(arguments + " --frames 2 --overwrite").exit_code, 0);
  EXPECT_EQ(run_penumbra(arguments + " --frames 1 --overwrite").exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "sequences/00/image_0/000001.png"));  // of the longer run
  EXPECT_TRUE(std::filesystem::exists(folder / "notes.txt"));
}

TEST(Synth, WrongArgumentsGiveExitCode2AndBadFiles1) {
  const TemporaryDirectory folder;
  const std::string out = " --out " + (folder / "street").string();
  EXPECT_EQ(run_penumbra("synth").exit_code, 2);
  for (const char* wrong : {"--size 620", "--size 620x", "--size ax188", "--size 620x188x3", "--size 0x0",
                            "--size 99999x99999", "--size -620x188", "--frames 0", "--frames -3",
                            "--frames many", "--preset jungle", "--path spiral", "--seed -1"}) {
    EXPECT_EQ(run_penumbra(std::string("synth ") + wrong + out).exit_code, 2) << wrong;
  }
  const ProgramResult missing = run_penumbra("synth --path no/such/poses.txt" + out);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("no/such/poses.txt"), std::string::npos);
  std::ofstream(folder / "poses.txt") << "1 2 3\n";
  EXPECT_EQ(run_penumbra("synth --path " + (folder / "poses.txt").string() + out).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "street"));
  std::ofstream(folder / "file") << "x";
  EXPECT_EQ(run_penumbra("synth --frames 1 --out " + (folder / "file").string()).exit_code, 2);
}

}  // namespace
}  // namespace penumbra::test
