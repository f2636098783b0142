#include "slam/sources/tum.h"

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

class Tum : public testing::Test {
 protected:
  static constexpr int kFrames = 4;

  void SetUp() override {
    for (const char* name : {"rgb", "depth"}) fs::create_directories(root() / name);
    std::string colour = "# timestamp filename\n", depth, truth = "# t tx ty tz qx qy qz qw\n";
    for (int i = 0; i < kFrames; ++i) {
      colour += fmt::format("{:.6f} rgb/{}.png\n", time(i), i);
      depth += fmt::format("{:.6f} depth/{}.png\n", time(i) + 0.015, i);
      truth += fmt::format("{:.4f} {} 0 0 0 0 0 1\n", time(i) + 0.003, i);
      test::write_mat(root() / fmt::format("rgb/{}.png", i), cv::Mat(60, 80, CV_8UC3, cv::Scalar(10, 20, i)));
      test::write_mat(root() / fmt::format("depth/{}.png", i),
                      cv::Mat(60, 80, CV_16UC1, cv::Scalar(5000 + i)));
    }
    nn::write_file(root() / "rgb.txt", colour);
    nn::write_file(root() / "depth.txt", depth);
    nn::write_file(root() / "groundtruth.txt", truth);
    nn::write_file(root() / "calibration.yaml", kCalibration);
  }
  static double time(int i) { return 1305031102.175304 + 0.1 * i; }
  fs::path root() const { return folder_ / "drive"; }
  void expect_refused(std::initializer_list<std::string> parts, const std::string& folder = "drive") const {
    expect_error<InputError>([&] { open_dataset(folder_ / folder); }, parts);
  }
  const std::string kCalibration =
      "width: 80\nheight: 60\nfx: 70\nfy: 71\ncx: 40\ncy: 30\ndepth_factor: 5000\nrate: 10\n";
  test::TemporaryDirectory folder_;
};

TEST_F(Tum, ColourIsPairedWithTheNearestDepth) {
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->name(), "TUM RGB-D drive");
  EXPECT_EQ(dataset->sensor(), Sensor::rgbd);
  EXPECT_EQ(dataset->size(), kFrames);
  EXPECT_EQ(dataset->camera().fy, 71.0);
  EXPECT_GT(dataset->camera().baseline, 0.0);
  const StereoImages images = dataset->load(2);
  EXPECT_NEAR(images.timestamp, time(2), 1e-5);
  for (const int c : {0, 1, 2}) EXPECT_EQ(images.left.at(0, 0, c), (c == 0 ? 10 : c == 1 ? 20 : 2));
  EXPECT_TRUE(images.right.empty());
  ASSERT_FALSE(images.depth.empty());
  EXPECT_FLOAT_EQ(images.depth.at(5, 5), 5002.0F / 5000.0F);
  ASSERT_EQ(dataset->ground_truth()->size(), 4U);
  EXPECT_EQ(dataset->ground_truth()->at(2).timestamp, images.timestamp);
  EXPECT_EQ(dataset->ground_truth()->at(2).T_wc.translation.x(), 2.0);
  DatasetOptions grey;
  grey.cameras = DatasetCameras::grey;
  EXPECT_EQ(open_dataset(root(), grey)->load(0).left.channels(), 1);
}

TEST_F(Tum, StepTakesEveryNthFrame) {
  DatasetOptions options;
  options.step = 2;
  options.frames = parse_frame_range("1:");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root(), options);
  ASSERT_EQ(dataset->size(), 2);
  EXPECT_EQ(dataset->load(1).index, 3);
  EXPECT_EQ(dataset->ground_truth()->size(), 2U);
  options.step = 0;
  expect_error<UsageError>([&] { open_dataset(root(), options); }, {"step 0"});
}

TEST_F(Tum, KnowsTheBenchmarksCamerasByTheFoldersName) {
  fs::remove(root() / "calibration.yaml");
  expect_refused({"calibration.yaml", "freiburg1", "'drive'"});
  const fs::path renamed = folder_ / "rgbd_dataset_freiburg3_desk";
  fs::rename(root(), renamed);
  expect_refused({"640 x 480", "80 x 60"}, "rgbd_dataset_freiburg3_desk");  // these images are smaller
  const cv::Mat colour(480, 640, CV_8UC3, cv::Scalar::all(100)), depth(480, 640, CV_16UC1, cv::Scalar(5000));
  for (int i = 0; i < kFrames; ++i) {
    test::write_mat(renamed / fmt::format("rgb/{}.png", i), colour);
    test::write_mat(renamed / fmt::format("depth/{}.png", i), depth);
  }
  EXPECT_EQ(open_dataset(renamed)->camera().fx, 535.4);
  fs::rename(renamed, folder_ / "my_fr1");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder_ / "my_fr1");
  EXPECT_NE(dataset->camera().fx, 517.306408);  // undistorted
  EXPECT_EQ(dataset->load(0).depth.at(320, 240), 1.0F);
}

TEST_F(Tum, ImagesWithoutPartnerAreLeftOut) {
  nn::write_file(root() / "depth.txt", fmt::format("{:.6f} depth/1.png\n", time(1) - 0.019));
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_EQ(dataset->size(), 1);
  ASSERT_FALSE(dataset->notes().empty());
  EXPECT_NE(dataset->notes().front().find("3 images without a partner"), std::string::npos);
  nn::write_file(root() / "depth.txt", "1.0 depth/1.png\n");
  expect_refused({"within 0.02 s", "none"});
}

TEST_F(Tum, ALinkMaySayWhichCameraItWas) {
  const cv::Mat colour(480, 640, CV_8UC3, cv::Scalar::all(100)), depth(480, 640, CV_16UC1, cv::Scalar(5000));
  for (int i = 0; i < kFrames; ++i) {
    test::write_mat(root() / fmt::format("rgb/{}.png", i), colour);
    test::write_mat(root() / fmt::format("depth/{}.png", i), depth);
  }
  fs::remove(root() / "calibration.yaml");
  fs::rename(root(), folder_ / "desk");
  expect_refused({"freiburg1", "'desk'"}, "desk");
  fs::create_directory_symlink("desk", folder_ / "my_fr3");
  EXPECT_EQ(open_dataset(folder_ / "my_fr3")->camera().fx, 535.4);
  EXPECT_EQ(open_dataset(folder_ / "my_fr3/")->camera().fx, 535.4);
}

// As the benchmark's own tool does it: where two colour images are nearest to one depth image, the second
// takes the next, if that is near enough.
TEST_F(Tum, PairsOneToOneNearestFirst) {
  const auto list = [&](const char* name, const char* folder, std::initializer_list<double> offsets) {
    std::string text;
    int i = 0;
    for (const double offset : offsets)
      text += fmt::format("{:.6f} {}/{}.png\n", time(0) + offset, folder, i++);
    nn::write_file(root() / name, text);
  };
  list("rgb.txt", "rgb", {0.000, 0.030});
  list("depth.txt", "depth", {0.016, 0.038});  // both are nearest to 0.030
  EXPECT_EQ(open_dataset(root())->size(), 2);
  DatasetOptions options;
  options.pair_within = 0.015;
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root(), options);
  EXPECT_EQ(dataset->size(), 1);
  EXPECT_NE(dataset->notes().front().find("1 pair of 2 colour and 2 depth images"), std::string::npos);
}

TEST_F(Tum, BadFilesAreRefused) {
  nn::write_file(root() / "rgb.txt", "1.0 rgb/0.png\n0.9 rgb/1.png\n");
  expect_refused({"rgb.txt:2", "a time after"});
  nn::write_file(root() / "rgb.txt", "inf rgb/0.png\n");
  expect_refused({"rgb.txt:1", "a finite number"});
  SetUp();
  test::write_mat(root() / "depth/0.png", cv::Mat(60, 80, CV_8UC1, cv::Scalar(50)));
  expect_refused({"depth/0.png", "16-bit grey PNG", "1 channel of 8 bits"});
  test::write_mat(root() / "depth/0.png", cv::Mat(61, 80, CV_16UC1, cv::Scalar(50)));
  expect_refused({"depth/0.png", "80 x 60", "80 x 61"});
  SetUp();
  fs::remove(root() / "depth.txt");
  expect_refused({"depth.txt", "no such file"});
}

TEST_F(Tum, BadCalibrationIsRefused) {
  const auto with = [&](const std::string& from, const std::string& to,
                        std::initializer_list<std::string> parts) {
    std::string text = kCalibration;
    text.replace(text.find(from), from.size(), to);
    nn::write_file(root() / "calibration.yaml", text);
    expect_refused(parts);
  };
  with("fx: 70", "fx: 0", {"calibration.yaml:3 (fx)", "above 0"});
  with("fx: 70", "fy: 70", {"calibration.yaml:4", "every key once"});
  with("cx: 40", "", {"the key cx"});
  with("depth_factor: 5000", "depth_factor: -1", {"(depth_factor)", "above 0"});
  with("width: 80", "width: 80.5", {"(width)", "a whole number of pixels"});
  with("width: 80", "sensor: mono", {"(sensor)", "stereo or rgbd", "'mono'"});
  with("width: 80\n", "", {"width and height", "one of them"});
}

const char* const kOpenLorisSensors =
    "%YAML:1.0\n---\nt265_gyroscope:\n   sensor_type: gyroscope\n   fps: 200\n   bias_variances: "
    "!!opencv-matrix\n"
    "      rows: 1\n      cols: 3\n      dt: d\n      data: [ 1.0e-07, 2.0e-07,\n          3.0e-07 ]\n"
    "d400_color_optical_frame:\n   sensor_type: camera\n   sensor_name: d400_color_optical_frame\n   fps: "
    "30\n"
    "   width: 80\n   height: 60\n   model: pinhole\n   intrinsics: !!opencv-matrix\n      rows: 1\n      "
    "cols: 4\n"
    "      dt: d\n      data: [ 6.1e+01, 4.1e+01, 6.2e+01,\n          2.9e+01 ]\n"
    "   distortion_model: radial-tangential\n   distortion_coefficients: !!opencv-matrix\n      rows: 1\n"
    "      cols: 5\n      dt: d\n      data: [ 0., 0., 0., 0., 0. ]\n";
// The camera, 1 m above the robot's base, looks along the robot's x.
const char* const kOpenLorisMounting =
    "%YAML:1.0\n---\ntrans_matrix:\n   -\n      parent_frame: base_link\n      child_frame: laser\n"
    "      matrix: !!opencv-matrix\n         rows: 4\n         cols: 4\n         dt: d\n"
    "         data: [ 1., 0., 0., 9., 0., 1., 0., 9., 0., 0., 1., 9., 0., 0., 0., 1. ]\n   -\n"
    "      parent_frame: base_link\n      child_frame: d400_color_optical_frame\n"
    "      matrix: !!opencv-matrix\n         rows: 4\n         cols: 4\n         dt: d\n"
    "         data: [ 0., 0., 1., 0.25, -1., 0., 0., 0.,\n             0., -1., 0., 1., 0., 0., 0., 1. ]\n";

TEST_F(Tum, OpenLorisHasTheSameListsUnderOtherNames) {
  fs::remove(root() / "calibration.yaml");
  fs::rename(root() / "rgb.txt", root() / "color.txt");
  fs::rename(root() / "depth.txt", root() / "aligned_depth.txt");
  nn::write_file(root() / "sensors.yaml", kOpenLorisSensors);
  nn::write_file(root() / "trans_matrix.yaml", kOpenLorisMounting);
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root());
  EXPECT_TRUE(dataset->name().starts_with("OpenLORIS ")) << dataset->name();
  EXPECT_EQ(dataset->size(), kFrames);
  EXPECT_EQ(dataset->camera().fx, 61.0);
  EXPECT_EQ(dataset->camera().cx, 41.0);
  EXPECT_EQ(dataset->camera().fy, 62.0);
  EXPECT_EQ(dataset->camera().cy, 29.0);
  ASSERT_TRUE(dataset->ground_truth());
  const SE3& camera = (*dataset->ground_truth())[2].T_wc;
  EXPECT_NEAR((camera.translation - Eigen::Vector3d(2.25, 0.0, 1.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((camera.rotation.col(2) - Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-9);

  const Eigen::Vector3d on_the_base =
      mounting_of("base_link", dataset->mountings(), "here").T_frame_camera.translation;
  EXPECT_EQ(on_the_base, Eigen::Vector3d(0.25, 0.0, 1.0));

  fs::remove(root() / "trans_matrix.yaml");
  const std::unique_ptr<StereoDataset> of_base = open_dataset(root());
  EXPECT_NEAR((*of_base->ground_truth())[2].T_wc.translation.z(), 0.0, 1e-9);
  EXPECT_NE(of_base->notes().back().find("the path of the robot's base"), std::string::npos);
  nn::write_file(root() / "sensors.yaml", "d400_color_optical_frame:\n   width: 80\n   height: 60\n");
  expect_error<InputError>([&] { open_dataset(root()); }, {"sensors.yaml", "intrinsics"});
}

TEST(TumRealData, PieceOfXyzIsRead) {
  PENUMBRA_REAL_DATA(folder, "tum/rgbd_dataset_freiburg1_xyz");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  EXPECT_EQ(dataset->size(), 36);
  EXPECT_EQ(dataset->ground_truth()->size(), 36U);
}

}  // namespace
}  // namespace penumbra::slam
