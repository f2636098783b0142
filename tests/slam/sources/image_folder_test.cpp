#include "slam/sources/image_folder.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/sources/calibration/calibration.h"
#include "tests/support/cv_images.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

namespace fs = std::filesystem;
using test::expect_error;

constexpr const char* kRectified = "fx: 70\nfy: 70\ncx: 40\ncy: 30\nbaseline: 0.12\nrate: 20\n";
constexpr const char* kRaw =
    "rectified: false\nwidth: 80\nheight: 60\nrate: 20\n"
    "left:\n  fx: 70\n  fy: 70\n  cx: 40\n  cy: 30\n  distortion: [-0.01, 0.0, 0.0, 0.0]\n"
    "right:\n  fx: 71\n  fy: 71\n  cx: 41\n  cy: 30\n  distortion: [-0.01, 0.0, 0.0, 0.0]\n"
    "T_right_left: [1, 0, 0, -0.12, 0, 1, 0, 0, 0, 0, 1, 0]\n";

class ImageFolder : public testing::Test {
 protected:
  void SetUp() override {
    make_images("left", {"000003", "000004", "000005"}, CV_8UC1);
    make_images("right", {"000003", "000004", "000005"}, CV_8UC1);
    calibrate(kRectified);
  }
  fs::path root() const { return folder_ / "my_camera"; }
  void make_images(const std::string& name, const std::vector<std::string>& stems, int type) const {
    fs::remove_all(root() / name);
    fs::create_directories(root() / name);
    for (std::size_t i = 0; i < stems.size(); ++i) {
      test::write_mat(root() / name / (stems[i] + ".png"),
                      cv::Mat(60, 80, type, cv::Scalar::all(10.0 * double(i))));
    }
  }
  void calibrate(const std::string& text) const { nn::write_file(root() / "calibration.yaml", text); }
  void expect_refused(std::initializer_list<std::string> parts) const {
    expect_error<InputError>([&] { open_dataset(root()); }, parts);
  }
  test::TemporaryDirectory folder_;
};

TEST_F(ImageFolder, RectifiedPairsAreReadInTheOrderOfTheirNames) {
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->name(), "my_camera");
  EXPECT_EQ(dataset->size(), 3);
  EXPECT_EQ(dataset->camera().baseline, 0.12);
  EXPECT_EQ(dataset->camera().width, 80);
  EXPECT_DOUBLE_EQ(dataset->timestamp(2), 0.1);
  EXPECT_EQ(dataset->load(1).left.channels(), 1);
  EXPECT_EQ(dataset->load(1).left.at(0, 0), 10);
  calibrate(std::string(kRectified) + "colour: true\n");
  EXPECT_EQ(open_dataset(root())->load(1).left.channels(), 3);
}

TEST_F(ImageFolder, RawPairsAreRectified) {
  calibrate(kRaw);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_NEAR(dataset->camera().baseline, 0.12, 1e-12);
  EXPECT_EQ(dataset->load(2).right.at(40, 30), 20);
}

TEST_F(ImageFolder, RgbdIsReadWithItsDepthScale) {
  make_images("rgb", {"1", "2"}, CV_8UC3);
  make_images("depth", {"1", "2"}, CV_16UC1);
  calibrate("sensor: rgbd\nfx: 70\nfy: 70\ncx: 40\ncy: 30\ndepth_factor: 1000\nrate: 30\nbaseline: 0.05\n");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->sensor(), Sensor::rgbd);
  EXPECT_EQ(dataset->camera().baseline, 0.05);
  EXPECT_EQ(dataset->load(1).left.channels(), 3);
  EXPECT_FLOAT_EQ(dataset->load(1).depth.at(0, 0), 0.01F);
}

TEST_F(ImageFolder, TimesComeFromTheFileTheNamesOrTheRate) {
  nn::write_file(root() / "times.txt", "5\n6\n8\n");
  EXPECT_EQ(open_dataset(root())->timestamp(2), 8.0);
  nn::write_file(root() / "times.txt", "5\n6\n");
  expect_refused({"times.txt", "times of 3 frames", "2"});
  nn::write_file(root() / "times.txt", "5\n6\n5.5\n");
  expect_refused({"times.txt:3", "a time after 6.000000 s"});
  fs::remove(root() / "times.txt");
  for (const char* name : {"left", "right"})
    make_images(name, {"1403715273262142976", "1403715273312142976"}, CV_8UC1);
  EXPECT_NEAR(open_dataset(root())->timestamp(1) - open_dataset(root())->timestamp(0), 0.05, 1e-6);
  for (const char* name : {"left", "right"}) make_images(name, {"12.5", "13.25"}, CV_8UC1);
  EXPECT_EQ(open_dataset(root())->timestamp(1), 13.25);
  for (const char* name : {"left", "right"}) make_images(name, {"1", "2"}, CV_8UC1);
  calibrate("fx: 70\nfy: 70\ncx: 40\ncy: 30\nbaseline: 0.12\n");
  expect_refused({"times.txt", "rate"});
  DatasetOptions options;
  options.frame_rate = 4.0;
  EXPECT_EQ(open_dataset(root(), options)->timestamp(1), 0.25);
}

TEST_F(ImageFolder, TimesAreInTheUnitThatFits) {
  const auto step = [&] { return open_dataset(root())->timestamp(1) - open_dataset(root())->timestamp(0); };
  nn::write_file(root() / "times.txt", "1403636579763555584\n1403636579863555584\n1403636579963555584\n");
  EXPECT_NEAR(step(), 0.1, 1e-6);
  ASSERT_FALSE(open_dataset(root())->notes().empty());
  EXPECT_NE(open_dataset(root())->notes().front().find("nanoseconds (not seconds)"), std::string::npos);
  nn::write_file(root() / "times.txt", "0\n33\n67\n");
  EXPECT_NEAR(step(), 0.033, 1e-9);
  nn::write_file(root() / "times.txt", "1e14\n2e14\n3e14\n");
  expect_refused({"times.txt", "seconds", "1e+14"});
  fs::remove(root() / "times.txt");
  const auto name = [&](const std::vector<std::string>& stems) {
    for (const char* folder : {"left", "right"}) make_images(folder, stems, CV_8UC1);
  };
  name({"1403636579763555", "1403636579826055", "1403636579888555"});
  EXPECT_NEAR(step(), 0.0625, 1e-6);
  name({"1403636579763", "1403636579863"});
  EXPECT_NEAR(step(), 0.1, 1e-6);
  name({"1403636579", "1403636580"});
  EXPECT_NEAR(step(), 1.0, 1e-9);
  name({"0000000009", "0000000010"});  // frames of KITTI's raw data
  EXPECT_NEAR(step(), 0.05, 1e-9);
  name({"000000000000000010", "000000000000000020"});  // many zeros make no clock
  EXPECT_NEAR(step(), 0.05, 1e-9);
  name({"20190131123456", "20190131123457"});
  EXPECT_NEAR(step(), 0.05, 1e-9);
  EXPECT_NE(open_dataset(root())->notes().front().find("a date"), std::string::npos);
  name({"12.5", "12.25", "12.75"});
  EXPECT_EQ(open_dataset(root())->timestamp(0), 12.25);
  EXPECT_EQ(open_dataset(root())->load(0).left.at(0, 0), 10);
}

TEST_F(ImageFolder, NamesAreInTheOrderOfTheirNumbers) {
  for (const char* folder : {"left", "right"}) make_images(folder, {"0", "1", "2", "10", "11"}, CV_8UC1);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  ASSERT_EQ(dataset->size(), 5);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(dataset->load(i).left.at(0, 0), 10 * i);
}

TEST_F(ImageFolder, ATimeBelongsToThePlaceBeforePairing) {
  for (const char* folder : {"left", "right"}) make_images(folder, {"0", "1", "2", "3"}, CV_8UC1);
  fs::remove(root() / "right/1.png");
  EXPECT_DOUBLE_EQ(open_dataset(root())->timestamp(1), 0.1);  // of 20 Hz
  EXPECT_EQ(open_dataset(root())->load(1).index, 2);
  nn::write_file(root() / "times.txt", "5\n6\n7\n8\n");
  EXPECT_EQ(open_dataset(root())->timestamp(2), 8.0);
  nn::write_file(root() / "times.txt", "5\n7\n8\n");
  EXPECT_EQ(open_dataset(root())->timestamp(1), 7.0);
  nn::write_file(root() / "times.txt", "5\n6\n");
  expect_refused({"times.txt", "times of 4 frames (or of the 3 with a partner)", "2"});
  fs::remove(root() / "times.txt");
  fs::remove(root() / "left/2.png");  // its place is known by the right image
  EXPECT_EQ(open_dataset(root())->size(), 2);
  EXPECT_DOUBLE_EQ(open_dataset(root())->timestamp(1), 0.15);
  nn::write_file(root() / "times.txt", "5\n6\n7\n8\n");
  EXPECT_EQ(open_dataset(root())->timestamp(1), 8.0);
}

TEST_F(ImageFolder, FramesWithOneTimeAreTakenOnce) {
  nn::write_file(root() / "times.txt", "5\n5\n6\n");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  ASSERT_EQ(dataset->size(), 2);
  EXPECT_EQ(dataset->load(1).left.at(0, 0), 20);
  ASSERT_FALSE(dataset->notes().empty());
  EXPECT_NE(dataset->notes().front().find("left out: 1 frame with the time of the frame before"),
            std::string::npos);
}

TEST_F(ImageFolder, WhatSystemsLeaveBehindIsSkipped) {
  for (const char* name : {"left/._000003.png", "left/.DS_Store", "right/Thumbs.db", "right/desktop.ini"})
    nn::write_file(root() / name, "x");
  fs::create_directories(root() / "left/@eaDir");
  fs::rename(root() / "left/000004.png", root() / "left/000004.PNG");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->size(), 3);
  EXPECT_TRUE(dataset->notes().empty());
  fs::remove_all(root() / "left");
  nn::write_file(root() / "left.txt", "");
  fs::create_directories(root() / "left");
  nn::write_file(root() / "left/000003.TIF", "II*");
  expect_refused({"left", "only .TIF", "mogrify -format png"});
}

TEST_F(ImageFolder, NamesMaySayTheirSide) {
  const auto pairs = [&](const std::vector<std::string>& left, const std::vector<std::string>& right) {
    make_images("left", left, CV_8UC1);
    make_images("right", right, CV_8UC1);
    return open_dataset(root())->size();
  };
  EXPECT_EQ(pairs({"000000_left", "000001_left"}, {"000000_right", "000001_right"}), 2);
  EXPECT_EQ(pairs({"L_0001", "L_0002"}, {"R_0001", "R_0002"}), 2);
  EXPECT_EQ(pairs({"left000001", "left000002"}, {"right000001", "right000002"}), 2);
  EXPECT_EQ(pairs({"cam0_1", "cam0_2", "cam0_3"}, {"cam1_1", "cam1_3"}), 2);
  EXPECT_EQ(pairs({"left_1", "left_2"}, {"left_1", "left_2"}), 2);
  EXPECT_EQ(pairs({"1L", "2L"}, {"1R", "2R"}), 2);
  make_images("right", {"x1", "x2"}, CV_8UC1);
  expect_refused({"right", "images of the same names", "'x1.png' beside '1L.png'"});
}

TEST_F(ImageFolder, SixteenBitsAreTakenAsTheyAreFilled) {
  const auto grey = [&](const std::vector<int>& levels, std::optional<int> bits = {}) {
    for (const char* folder : {"left", "right"}) {
      make_images(folder, {"0"}, CV_8UC1);
      cv::Mat image(60, 80, CV_16UC1, cv::Scalar(levels[0]));
      image.at<std::uint16_t>(1, 1) = static_cast<std::uint16_t>(levels[1]);
      test::write_mat(root() / folder / "0.png", image);
    }
    DatasetOptions options;
    options.image_bits = bits;
    return int{open_dataset(root(), options)->load(0).left.at(0, 0)};
  };
  EXPECT_EQ(grey({400, 1020}), 100);  // 10 bits
  EXPECT_NE(open_dataset(root())->notes().front().find("10 bits"), std::string::npos);
  EXPECT_EQ(grey({400, 4000}), 25);      // 12
  EXPECT_EQ(grey({40000, 60000}), 156);  // all
  EXPECT_EQ(grey({100, 255}), 100);      // 8
  EXPECT_EQ(grey({400, 1020}, 12), 25);
  EXPECT_EQ(grey({4095, 4095}, 10), 255);
  expect_error<UsageError>([&] { grey({400, 1020}, 7); }, {"--image-bits 7"});
}

TEST_F(ImageFolder, GroundTruthIsThatOfTheUnrectifiedLeftCamera) {
  nn::write_file(root() / "poses.txt",
                 "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 4\n");
  EXPECT_EQ(open_dataset(root())->ground_truth()->at(2).T_wc.translation.z(), 4.0);
  nn::write_file(root() / "poses.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n");
  expect_refused({"poses.txt", "poses of 3 frames", "1"});
}

TEST_F(ImageFolder, PartnersAreFoundByName) {
  make_images("right", {"000004", "000005", "000009"}, CV_8UC1);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->size(), 2);
  EXPECT_EQ(dataset->load(0).left.at(0, 0), 10);
  ASSERT_FALSE(dataset->notes().empty());
  EXPECT_NE(dataset->notes().front().find("2 images without a partner"), std::string::npos);
  make_images("right", {"x"}, CV_8UC1);
  expect_refused({"right", "images of the same names", "'x.png'"});
  fs::remove_all(root() / "right");
  expect_refused({"right", "a folder of images", "nothing"});
}

TEST_F(ImageFolder, BadCalibrationIsRefused) {
  const auto with = [&](std::string text, const std::string& from, const std::string& to,
                        std::initializer_list<std::string> parts) {
    text.replace(text.find(from), from.size(), to);
    calibrate(text);
    expect_refused(parts);
  };
  with(kRectified, "0.12", "0", {"(baseline)", "above 0"});
  with(kRectified, "0.12", "-0.12", {"(baseline)", "above 0"});
  with(kRectified, "rate: 20", "distortion: [1, 2, 3, 4]", {"(distortion)"});
  with(kRaw, "-0.12,", "0.12,", {"(T_right_left)", "to the right", "swapped"});
  with(kRaw, "[1, 0, 0,", "[2, 0, 0,", {"(T_right_left)", "a rotation"});
  with(kRaw, "width: 80\nheight: 60\n", "", {"width and height"});
  with(kRaw, "rectified: false", "rectified: maybe", {"(rectified)", "true or false", "'maybe'"});
  fs::remove(root() / "calibration.yaml");
  expect_refused({"my_camera", "calibration.yaml"});
}

TEST_F(ImageFolder, KeysHaveTheFieldsOtherNames) {
  const auto camera = [&](const std::string& text) {
    calibrate(text);
    return make_camera(read_camera_file(root() / "calibration.yaml")).camera;
  };
  const StereoCamera expected = camera(kRaw);
  std::string other = kRaw;
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = other.find(from, at)) != std::string::npos; at += to.size())
      other.replace(at, from.size(), to);
  };
  replace("distortion:", "distortion_coefficients:");
  EXPECT_EQ(camera(other).fx, expected.fx);
  replace("distortion_coefficients: [-0.01, 0.0, 0.0, 0.0]", "k1: -0.01\n  k2: 0.0\n  p1: 0.0\n  p2: 0.0");
  EXPECT_EQ(camera(other).fx, expected.fx);
  replace("width: 80\nheight: 60", "resolution: [80, 60]");
  replace("rate:", "fps:");
  replace("  fx: 70\n  fy: 70\n  cx: 40\n  cy: 30\n", "  camera_matrix: [70, 0, 40, 0, 70, 30, 0, 0, 1]\n");
  EXPECT_EQ(camera(other).fx, expected.fx);
  replace("T_right_left: [1, 0, 0, -0.12", "T_left_right: [1, 0, 0, 0.12");
  EXPECT_EQ(camera(other).fx, expected.fx);
  EXPECT_DOUBLE_EQ(camera("intrinsics: [70, 71, 40, 30]\nbf: 8.4\n").baseline, 0.12);
  const std::string rgbd = "sensor: rgbd\nintrinsics: [70, 71, 40, 30]\n";
  const auto factor = [&](const std::string& text) {
    calibrate(rgbd + text);
    return read_camera_file(root() / "calibration.yaml").depth_factor;
  };
  EXPECT_EQ(factor("DepthMapFactor: 5000\n"), 5000.0);
  EXPECT_EQ(factor("depth_scale: 1000\n"), 1000.0);
  EXPECT_EQ(factor("depth_scale: 0.001\n"), 1000.0);
  calibrate(rgbd + "depth_factor: 0.001\n");
  expect_refused({"(depth_factor)", "levels a metre, at least 1 (such as 1000)", "0.001"});
}

TEST_F(ImageFolder, UnknownKeysAreRefusedWithTheNearest) {
  const auto with = [&](const std::string& text, std::initializer_list<std::string> parts) {
    calibrate(text);
    expect_refused(parts);
  };
  with(std::string(kRectified) + "basline: 3\n", {"calibration.yaml:7 (basline)", "(is 'baseline' meant?)"});
  with(std::string(kRectified) + "zzzzzz: 3\n", {"a key that is known", "'zzzzzz'"});
  with(std::string(kRectified) + "fps: 3\n",
       {"(fps)", "one of two keys for rate", "calibration.yaml:6 (rate)"});
  with(std::string(kRectified) + "bf: 3\n", {"(bf)", "one of two ways", "(baseline)"});
  with(std::string(kRectified) + "depth_factor: 5000\nsensor: stereo\n", {"(depth_factor)", "sensor: rgbd"});
  with(std::string(kRaw) + "distortion: [1, 2, 3, 4]\n", {"(distortion)", "left: and right:"});
  with(std::string(kRaw) + "baseline: 3\n", {"(baseline)", "T_right_left"});
  with(std::string(kRectified) + "distortion_model: equidistant\n", {"(distortion_model)", "coefficients"});
  with("%YAML:1.0\nCamera.type: \"PinHole\"\nCamera.fx: 3\n",
       {"calibration.yaml", "looks like ORB-SLAM's settings"});
  with("cam0:\n  cam_overlaps: [1]\n", {"looks like Kalibr's camchain"});
  with("image_width: 80\ncamera_matrix:\n  rows: 3\n  data: [1]\nprojection_matrix:\n  data: [1]\n",
       {"ROS's camera_info"});
}

TEST_F(ImageFolder, ALensThatCannotBeIsRefusedOrUndoneFinitely) {
  for (const char* distortion : {"[-1e9, 1e9, 0, 0]", "[1e300, 0, 0, 0]", "[-5, 30, 0, 0, -60]"}) {
    SCOPED_TRACE(distortion);
    calibrate(
        fmt::format("sensor: rgbd\nwidth: 80\nheight: 60\nfx: 70\nfy: 70\ncx: 40\ncy: 30\n"
                    "depth_factor: 1000\ndistortion: {}\n",
                    distortion));
    try {
      const StereoCamera camera = make_camera(read_camera_file(root() / "calibration.yaml")).camera;
      EXPECT_TRUE(camera.fx > 0.0 && camera.fx < 7000.0 && std::isfinite(camera.cy));
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("calibration.yaml"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace penumbra::slam
