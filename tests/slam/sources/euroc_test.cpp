#include "slam/sources/euroc.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "tests/support/cv_images.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

namespace fs = std::filesystem;
using test::expect_error;

std::string sensor_yaml(double x) {
  return fmt::format(
      "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n"
      "  data: [1.0, 0.0, 0.0, {},\n         0.0, 1.0, 0.0, 0.2,\n         0.0, 0.0, 1.0, 0.0,\n"
      "         0.0, 0.0, 0.0, 1.0]\nrate_hz: 20\nresolution: [80, 60]\ncamera_model: pinhole\n"
      "intrinsics: [70.0, 70.0, 40.0, 30.0] #fu, fv, cu, cv\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [-0.01, 0.001, 0.0, 0.0]\n",
      x);
}

class Euroc : public testing::Test {
 protected:
  static constexpr long long kStart = 1403715273262142976;
  static constexpr int kFrames = 4;

  void SetUp() override {
    for (int c = 0; c < 2; ++c) {
      fs::create_directories(camera(c) / "data");
      nn::write_file(camera(c) / "sensor.yaml", sensor_yaml(0.1 * c));
      std::string list = "#timestamp [ns],filename\r\n";
      for (int i = 0; i < kFrames; ++i) {
        list += fmt::format("{0},{0}.png\r\n", time(i));
        test::write_mat(camera(c) / fmt::format("data/{}.png", time(i)),
                        cv::Mat(60, 80, CV_8UC1, cv::Scalar(50 * c + i)));
      }
      nn::write_file(camera(c) / "data.csv", list);
    }
  }
  static long long time(int i) { return kStart + 50'000'000LL * i; }
  fs::path root() const { return folder_ / "V1_01_easy"; }
  fs::path camera(int c) const { return root() / fmt::format("mav0/cam{}", c); }
  void expect_refused(std::initializer_list<std::string> parts) const {
    expect_error<InputError>([&] { open_dataset(root()); }, parts);
  }
  test::TemporaryDirectory folder_;
};

TEST_F(Euroc, IsReadFromTheFolderAndFromMav0) {
  for (const fs::path& path : {root(), root() / "mav0", root() / "mav0/"}) {
    const std::unique_ptr<StereoDataset> dataset = open_dataset(path);
    EXPECT_EQ(dataset->name(), "EuRoC V1_01_easy");
    EXPECT_EQ(dataset->sensor(), Sensor::stereo);
    EXPECT_EQ(dataset->size(), kFrames);
    EXPECT_NEAR(dataset->camera().baseline, 0.1, 1e-9);
    EXPECT_EQ(dataset->camera().width, 80);
    EXPECT_NEAR(dataset->timestamp(1) - dataset->timestamp(0), 0.05, 1e-6);
    const StereoImages images = dataset->load(3);
    EXPECT_EQ(images.left.at(40, 30), 3);
    EXPECT_EQ(images.right.at(40, 30), 53);
    EXPECT_TRUE(images.depth.empty());
    EXPECT_FALSE(dataset->ground_truth().has_value());
    EXPECT_TRUE(dataset->notes().empty());
  }
}

TEST_F(Euroc, GroundTruthOfTheBodyBecomesThatOfTheLeftCamera) {
  fs::create_directories(root() / "mav0/state_groundtruth_estimate0");
  const fs::path csv = root() / "mav0/state_groundtruth_estimate0/data.csv";
  std::string text = "#timestamp, p_RS_R_x [m], ..., q_RS_w [], q_RS_x [], ...\n";
  // Turned by 90 degrees about z.
  for (int i = 1; i < kFrames; ++i) {
    text += fmt::format("{},{},2,3,0.70710678118,0,0,0.70710678118,0,0,0\n", time(i) + 1'000'000, i);
  }
  nn::write_file(csv, text);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  ASSERT_TRUE(dataset->ground_truth().has_value());
  ASSERT_EQ(dataset->ground_truth()->size(), 3U);  // frame 0 has none
  const TimedPose& pose = dataset->ground_truth()->front();
  EXPECT_EQ(pose.timestamp, dataset->timestamp(1));
  // The camera sits at (0, 0.2, 0) of the body, which the turn takes to (-0.2, 0, 0).
  EXPECT_LT((pose.T_wc.translation - Eigen::Vector3d(0.8, 2.0, 3.0)).norm(), 1e-6);

  nn::write_file(csv, "1,0,0,0,1,0,0\n");
  expect_refused({"data.csv:1", "at least 8 numbers"});
  nn::write_file(csv, "1,0,0,0,0,0,0,0\n");
  expect_refused({"data.csv:1", "a quaternion", "length 0"});
  const std::string header = "#t,x,y,z,qw,qx,qy,qz\n";
  nn::write_file(csv, header + fmt::format("{},0,0,0,2,0,0,0\n{},0,0,0,1,0,0,0\n", time(1), time(0)));
  EXPECT_EQ(open_dataset(root())->notes().size(), 2U);  // of length 2, not in the order of time
  EXPECT_EQ(open_dataset(root())->ground_truth()->size(), 2U);
  nn::write_file(csv, header + "1,0,0,0,1,0,0,0\n");
  EXPECT_EQ(open_dataset(root())->notes().size(), 1U);  // times that are not the frames'
}

TEST_F(Euroc, ImagesWithoutPartnerAreLeftOutWithANote) {
  nn::write_file(camera(1) / "data.csv", fmt::format("{0},{0}.png\n{1},{1}.png\n", time(0), time(2)));
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->size(), 2);
  ASSERT_EQ(dataset->notes().size(), 1U);
  EXPECT_NE(dataset->notes().front().find("2 images without a partner"), std::string::npos);
  EXPECT_EQ(dataset->load(1).left.at(40, 30), 2);
  nn::write_file(camera(1) / "data.csv", "5,x.png\n");
  expect_refused({"cam0 and cam1 with the same times"});
}

TEST_F(Euroc, MicrosecondsAndRepeatedTimesAreTakenWithANote) {
  for (int c = 0; c < 2; ++c) {
    std::string list;
    for (const int i : {0, 1, 1, 2, 3}) list += fmt::format("{},{}.png\n", time(i) / 1000, time(i));
    nn::write_file(camera(c) / "data.csv", list);
  }
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->size(), 4);
  EXPECT_NEAR(dataset->timestamp(1) - dataset->timestamp(0), 0.05, 1e-6);
  ASSERT_EQ(dataset->notes().size(), 4U);
  EXPECT_NE(dataset->notes()[0].find("microseconds (not nanoseconds)"), std::string::npos);
  EXPECT_NE(dataset->notes()[1].find("left out: 1 image with the time of the one before"), std::string::npos);
}

TEST_F(Euroc, LongGapsAreNoted) {
  std::string list;
  for (const int i : {0, 1, 3}) list += fmt::format("{0},{1}.png\n", time(i), time(i));
  for (int c = 0; c < 2; ++c) nn::write_file(camera(c) / "data.csv", list);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  ASSERT_EQ(dataset->notes().size(), 1U);
  EXPECT_NE(dataset->notes().front().find("the longest gap, of 0.1 s, is after frame 1"), std::string::npos)
      << dataset->notes().front();
}

TEST_F(Euroc, BrokenListsAreRefusedWithTheirLine) {
  const auto with_list = [&](const std::string& text, std::initializer_list<std::string> parts) {
    nn::write_file(camera(0) / "data.csv", text);
    expect_refused(parts);
  };
  with_list("", {"cam0/data.csv", "images", "an empty list"});
  with_list("5 a.png\n", {"data.csv:1", "NANOSECONDS,NAME", "'5 a.png'"});
  with_list("# c\nx,a.png\n", {"data.csv:2", "a number", "'x'"});
  with_list("50000000,a.png\n0,b.png\n", {"data.csv:2", "a time after"});
  with_list("5,\n", {"data.csv:1", "the name of an image"});
  with_list("5,../a.png\n", {"data.csv:1", "'../a.png'"});
  with_list("5,/etc/a.png\n", {"data.csv:1", "'/etc/a.png'"});
  fs::remove(camera(0) / "data.csv");
  expect_refused({"cam0/data.csv", "no such file"});
}

TEST_F(Euroc, BrokenCalibrationIsRefused) {
  const std::string good = sensor_yaml(0.1);
  const auto with = [&](const std::string& from, const std::string& to,
                        std::initializer_list<std::string> parts) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    nn::write_file(camera(1) / "sensor.yaml", text);
    expect_refused(parts);
  };
  with("70.0, 70.0", "0.0, 70.0", {"cam1/sensor.yaml:13 (intrinsics)", "focal lengths > 0"});
  with("70.0, 70.0", "nan, 70.0", {"(intrinsics)", "a finite number"});
  with("[80, 60]", "[80, 0]", {"(resolution)", "a whole number of pixels", "0"});
  with("[80, 60]", "[60000, 60000]", {"(resolution)", "an image that can be"});
  with("[80, 60]", "[80, 61]", {"same size", "80 x 61"});
  with("pinhole", "omni", {"(camera_model)", "pinhole", "'omni'"});
  with("radial-tangential", "fov", {"equidistant", "'fov'"});
  with("[1.0, 0.0", "[2.0, 0.0", {"(T_BS.data)", "a rotation"});
  with("0.1,", "-0.1,", {"cam1/sensor.yaml", "to the right", "swapped"});
  with("T_BS", "T_BX", {"cam1/sensor.yaml:6 (T_BX.data)", "a key that is known (is 'T_BS' meant?)"});
  with("distortion_coefficients", "distorsion_coefficients", {"(is 'distortion_coefficients' meant?)"});
}

TEST_F(Euroc, ImageOfAnotherSizeOrMissingIsRefused) {
  test::write_mat(camera(1) / fmt::format("data/{}.png", time(0)), cv::Mat(60, 81, CV_8UC1, cv::Scalar(0)));
  expect_refused({"80 x 60 pixels as in the calibration", "81 x 60"});
  // One that is missing costs its frame, which says so when it is read, and the others tell the size.
  fs::remove(camera(1) / fmt::format("data/{}.png", time(0)));
  const auto dataset = open_dataset(root());
  expect_error<InputError>([&] { dataset->load(0); }, {fmt::format("{}.png", time(0)), "no such file"});
  EXPECT_FALSE(dataset->load(1).left.empty());
}

TEST(EurocRealData, SparseFlightIsRectified) {
  PENUMBRA_REAL_DATA(folder, "euroc/V1_01_easy_sparse");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  EXPECT_EQ(dataset->size(), 82);
  EXPECT_NEAR(dataset->camera().baseline, 0.11007, 1e-4);
  EXPECT_NEAR(dataset->camera().fx, 435.2, 2.0);  // near that of the calibration that ORB-SLAM2 ships
  ASSERT_TRUE(dataset->ground_truth().has_value());
  EXPECT_EQ(dataset->ground_truth()->size(), 82U);
}

}  // namespace
}  // namespace penumbra::slam
