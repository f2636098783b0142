// Data sets as they are downloaded, each with the truth that lies there: laid out small, of plain images.
#include "slam/sources/published.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/sources/kitti_raw.h"
#include "tests/support/cv_images.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

namespace fs = std::filesystem;
using test::expect_error;

class Published : public testing::Test {
 protected:
  void make_images(const fs::path& folder, const std::string& prefix, int digits, const std::string& suffix,
                   int type = CV_8UC1, int width = 80) const {
    fs::create_directories(root() / folder);
    for (int i = 0; i < 3; ++i) {
      test::write_mat(root() / folder / fmt::format("{}{:0{}}{}.png", prefix, i, digits, suffix),
                      cv::Mat(60, width, type, cv::Scalar::all(10.0 * i)));
    }
  }
  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((root() / file).parent_path());
    nn::write_file(root() / file, text);
  }
  std::unique_ptr<StereoDataset> open(const fs::path& folder) const { return open_dataset(root() / folder); }
  fs::path root() const { return folder_.path(); }

 private:
  test::TemporaryDirectory folder_;
};

const char* const kRawCalibration =
    "calib_time: 09-Jan-2012 13:57:47\nS_rect_00: 8.0e+01 6.0e+01\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
    "P_rect_00: 70 0 40 0 0 70 30 0 0 0 1 0\nP_rect_01: 70 0 40 -35 0 70 30 0 0 0 1 0\n";
const char* const kDates =
    "2011-09-26 13:02:25.000000000\n2011-09-26 13:02:25.100000000\n2011-09-26 13:02:25.250000000\n";

TEST_F(Published, KittisRawDrivesWithTheTruthOfTheirInertialSensor) {
  const fs::path day = "2011_09_26", drive = day / "2011_09_26_drive_0001_sync";
  make_images(drive / "image_00" / "data", "", 10, "");
  make_images(drive / "image_01" / "data", "", 10, "");
  write(day / "calib_cam_to_cam.txt", kRawCalibration);
  write(drive / "image_00" / "timestamps.txt", kDates);
  const std::unique_ptr<StereoDataset> plain = open(drive);
  EXPECT_EQ(plain->name(), "KITTI raw 2011_09_26_drive_0001_sync");
  EXPECT_EQ(plain->size(), 3);
  EXPECT_DOUBLE_EQ(plain->camera().baseline, 0.5);
  EXPECT_NEAR(plain->timestamp(2) - plain->timestamp(0), 0.25, 1e-6);
  EXPECT_NEAR(plain->timestamp(0), 1317042145.0, 1e-6);  // as `date -u -d` has it
  EXPECT_FALSE(plain->ground_truth());

  // The car goes north by 1e-5 degrees a frame. The sensor looks along the car's x, the camera along z.
  for (int i = 0; i < 3; ++i) {
    write(drive / "oxts" / "data" / fmt::format("{:010}.txt", i),
          fmt::format("{:.9f} 8.0 110 0 0 {:.15f} 1 2 3\n", 49.0 + 1e-5 * i, std::acos(0.0)));
  }
  write(day / "calib_imu_to_velo.txt", "calib_time: x\nR: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  write(day / "calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n");
  const std::unique_ptr<StereoDataset> with_truth = open(drive);
  ASSERT_TRUE(with_truth->ground_truth());
  ASSERT_EQ(with_truth->ground_truth()->size(), 3U);
  const double metres = 2e-5 * std::acos(-1.0) / 180.0 * 6378137.0;
  EXPECT_LT(((*with_truth->ground_truth())[2].T_wc.translation - Eigen::Vector3d(0.0, 0.0, metres)).norm(),
            1e-4);
  EXPECT_LT(((*with_truth->ground_truth())[2].T_wc.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-9);

  // The sensor stands behind and above the camera: its place is turned with the car's axes.
  write(day / "calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.7\n");
  const std::unique_ptr<StereoDataset> mounted = open(drive);
  const SE3& T_imu_camera = mounting_of("imu", mounted->mountings(), "here").T_frame_camera;
  EXPECT_LT((T_imu_camera.translation - Eigen::Vector3d(0.8, -0.3, 0.7)).norm(), 1e-9);
  EXPECT_LT((T_imu_camera.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-9);

  fs::remove(root() / day / "calib_velo_to_cam.txt");
  EXPECT_FALSE(open(drive)->ground_truth());
  write(drive / "image_00" / "timestamps.txt", "2011-09-26 13:02:25.0\nyesterday\n2011-13-26 13:02:25\n");
  expect_error<InputError>([&] { open(drive); }, {"timestamps.txt:2", "a date and a time", "'yesterday'"});
}

TEST_F(Published, Kitti360WithPosesOfSomeFrames) {
  const fs::path drive = fs::path("data_2d_raw") / "2013_05_28_drive_0000_sync";
  make_images(drive / "image_00" / "data_rect", "", 10, "");
  make_images(drive / "image_01" / "data_rect", "", 10, "");
  write("calibration/perspective.txt", kRawCalibration);
  write(drive / "image_00" / "timestamps.txt", kDates);
  write("data_poses/2013_05_28_drive_0000_sync/cam0_to_world.txt",
        "0 1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1\n2 1 0 0 7 0 1 0 0 0 0 1 0 0 0 0 1\n");
  const std::unique_ptr<StereoDataset> dataset = open(drive);
  ASSERT_TRUE(dataset->ground_truth());
  ASSERT_EQ(dataset->ground_truth()->size(), 2U);
  EXPECT_EQ(dataset->ground_truth()->back().timestamp, dataset->timestamp(2));
  EXPECT_EQ(dataset->ground_truth()->back().T_wc.translation.x(), 7.0);
  EXPECT_TRUE(dataset->mountings().empty());

  // The rectified camera is turned against the one that is mounted: 90 degrees about its own x.
  std::string turned = kRawCalibration;
  turned.replace(turned.find("R_rect_00: ") + 11, 17, "1 0 0 0 0 -1 0 1 0");
  write("calibration/perspective.txt", turned);
  write("calibration/calib_cam_to_pose.txt",
        "image_00: 0 0 1 1.5 1 0 0 -0.25 0 1 0 0.75\nimage_01: 0 0 1 1.5 1 0 0 0.25 0 1 0 0.75\n");
  const std::unique_ptr<StereoDataset> with_imu = open(drive);
  const SE3& T = mounting_of("imu", with_imu->mountings(), "here").T_frame_camera;
  EXPECT_LT((T.translation - Eigen::Vector3d(1.5, -0.25, 0.75)).norm(), 1e-9);
  // (0 -1 0) of the mounted camera is the rectified one's (0 0 -1); up there is -y, and -z of the sensor.
  EXPECT_LT((T.rotation * Eigen::Vector3d(0, 0, -1) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-9);
}

TEST_F(Published, VirtualKittiWithTheInverseOfItsExtrinsics) {
  const fs::path scene = fs::path("Scene01") / "clone";
  make_images(scene / "frames" / "rgb" / "Camera_0", "rgb_", 5, "", CV_8UC3, 1242);
  make_images(scene / "frames" / "rgb" / "Camera_1", "rgb_", 5, "", CV_8UC3, 1242);
  write(scene / "extrinsic.txt",
        "frame cameraID r1,1 r1,2\n0 0 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n0 1 1 0 0 -0.53 0 1 0 0 0 0 1 0 0 0 "
        "0 1\n"
        "1 0 1 0 0 0 0 1 0 0 0 0 1 -3 0 0 0 1\n");
  // The images are of another height than the data set's.
  expect_error<InputError>([&] { open(scene); }, {"1242 x 375", "1242 x 60"});
}

TEST_F(Published, TartanAirsPosesLookAheadAlongX) {
  make_images("P001/image_left", "", 6, "_left", CV_8UC3, 640);
  make_images("P001/image_right", "", 6, "_right", CV_8UC3, 640);
  write("P001/pose_left.txt", "0 0 0 0 0 0 1\n2 0.5 0.25 0 0 0 1\n4 1 0.5 0 0 0 1\n");
  const std::unique_ptr<StereoDataset> dataset = open("P001");
  EXPECT_EQ(dataset->camera().baseline, 0.25);
  ASSERT_TRUE(dataset->ground_truth());
  // Its camera is that of images of 640 x 480 pixels; these have 640 x 60.
  ASSERT_EQ(dataset->notes().size(), 3U);  // 10 frames a second; the size; where that puts the centre
  EXPECT_NE(dataset->notes()[1].find("images of 640 x 480 pixels"), std::string::npos);
  EXPECT_NE(dataset->notes()[1].find("640 x 60"), std::string::npos);
  // 2 m ahead, 0.5 m to the right, 0.25 m down.
  EXPECT_LT(((*dataset->ground_truth())[1].T_wc.translation - Eigen::Vector3d(0.5, 0.25, 2.0)).norm(), 1e-12);
}

TEST_F(Published, FourSeasonsNeedsTheBaseline) {
  for (const char* camera : {"cam0", "cam1"}) {
    const fs::path folder = fs::path("recording/undistorted_images") / camera;
    fs::create_directories(root() / folder);
    for (const char* time : {"1403636579763555584", "1403636579796888917"})
      test::write_mat(root() / folder / (std::string(time) + ".png"),
                      cv::Mat(60, 80, CV_8UC1, cv::Scalar(9.0)));
  }
  write("calibration/undistorted_calib_0.txt", "Pinhole 70 70 40 30 0\n80 60\ncrop\n80 60\n");
  expect_error<InputError>([&] { open("recording"); }, {"undistorted_calib_stereo.txt"});
  write("calibration/undistorted_calib_stereo.txt", "1 0 0 -0.3\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const std::unique_ptr<StereoDataset> dataset = open("recording");
  EXPECT_NEAR(dataset->camera().baseline, 0.3, 1e-12);
  EXPECT_NEAR(dataset->timestamp(1) - dataset->timestamp(0), 0.033333333, 1e-6);
}

TEST_F(Published, IclNuimsTruthIsMirrored) {
  make_images("living/rgb", "", 1, "", CV_8UC3, 640);
  make_images("living/depth", "", 1, "", CV_16UC1, 640);
  write("living/associations.txt", "0 depth/0.png 0 rgb/0.png\n");
  write("living/livingRoom0.gt.freiburg", "0 0 0 0 0 0 0 1\n1 1 2 3 0 0 0 1\n2 2 4 6 0 0 0 1\n");
  expect_error<InputError>([&] { open("living"); }, {"640 x 480", "640 x 60"});
}

TEST_F(Published, HalvesOfOneImage) {
  fs::create_directories(root() / "zed" / "side_by_side");
  for (int i = 0; i < 3; ++i) {
    cv::Mat both(60, 160, CV_8UC1, cv::Scalar(20.0 + i));
    both.colRange(80, 160).setTo(100.0 + i);
    test::write_mat(root() / "zed" / "side_by_side" / fmt::format("{:06}.png", i), both);
  }
  write("zed/calibration.yaml", "fx: 70\nfy: 70\ncx: 40\ncy: 30\nbaseline: 0.12\nrate: 10\n");
  const std::unique_ptr<StereoDataset> dataset = open("zed");
  const StereoImages images = dataset->load(2);
  EXPECT_EQ(dataset->camera().width, 80);
  EXPECT_EQ(images.left.at(79, 59), 22);
  EXPECT_EQ(images.right.at(0, 0), 102);
}

TEST_F(Published, Eth3dAndBonnLieAsTumDoes) {
  for (const char* name : {"cables_1", "rgbd_bonn_balloon"}) {
    make_images(fs::path(name) / "rgb", "", 1, "", CV_8UC3, 640);
    make_images(fs::path(name) / "depth", "", 1, "", CV_16UC1, 640);
    write(fs::path(name) / "rgb.txt", "1.0 rgb/0.png\n1.1 rgb/1.png\n1.2 rgb/2.png\n");
    write(fs::path(name) / "depth.txt", "1.0 depth/0.png\n1.1 depth/1.png\n1.2 depth/2.png\n");
  }
  write("cables_1/calibration.txt", "70 70 320 30\n");
  EXPECT_EQ(open("cables_1")->camera().fx, 70.0);
  expect_error<InputError>([&] { open("rgbd_bonn_balloon"); }, {"640 x 480", "640 x 60"});
}

// A drive of three frames with the SDK beside it: its models of the wide and the narrow pair, which leave
// images as they are but for one pixel to the left.
class RobotCar : public Published {
 protected:
  static constexpr int kWidth = 80, kHeight = 60;
  static constexpr long long kStart = 1399381446204705, kStep = 62500;  // microseconds

  void SetUp() override {
    for (const char* side : {"left", "centre", "right"}) {
      fs::create_directories(root() / drive_ / "stereo" / side);
      for (int i = 0; i < 3; ++i) {
        // Green first, blue beside it, red below: a plain colour behind the mosaic.
        cv::Mat mosaic(kHeight, kWidth, CV_8UC1, cv::Scalar(40));
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            if (y % 2 == 0 && x % 2 == 1) mosaic.at<std::uint8_t>(y, x) = 10;
            if (y % 2 == 1 && x % 2 == 0) mosaic.at<std::uint8_t>(y, x) = 200;
          }
        }
        test::write_mat(root() / drive_ / "stereo" / side / fmt::format("{}.png", time(i)), mosaic);
      }
    }
    std::string times;
    for (int i = 0; i < 3; ++i) times += fmt::format("{} 1\n", time(i));
    write(drive_ / "stereo.timestamps", times);
    for (const char* pair : {"wide", "narrow"}) {
      for (const bool right : {false, true}) {
        const double baseline = right ? (pair[0] == 'w' ? 0.239983 : 0.119997) : 0.0;
        const std::string name = fmt::format("models/stereo_{}_{}", pair, right ? "right" : "left");
        write(sdk_ / (name + ".txt"),
              fmt::format("70 70 40 30 0\n0 0 1 0\n1 0 0 {}\n0 1 0 0\n0 0 0 1\n", baseline));
        std::string table;
        for (const bool rows : {false, true}) {
          for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
              const double place = rows ? y : x - 1;
              table.append(reinterpret_cast<const char*>(&place), sizeof place);
            }
          }
        }
        write(sdk_ / (name + "_distortion_lut.bin"), table);
      }
    }
  }
  static long long time(int i) { return kStart + i * kStep; }

  const fs::path drive_ = "2014-05-06-12-54-54", sdk_ = "robotcar-dataset-sdk";
};

TEST_F(RobotCar, TablesUndoTheLensesOfBothPairs) {
  DatasetOptions options;
  options.cameras = DatasetCameras::colour;
  const auto dataset = open_dataset(root() / drive_, options);
  EXPECT_EQ(dataset->name(), "RobotCar 2014-05-06-12-54-54");
  EXPECT_EQ(dataset->size(), 3);
  EXPECT_EQ(dataset->camera().fx, 70.0);
  EXPECT_NEAR(dataset->camera().baseline, 0.239983, 1e-9);
  EXPECT_NEAR(dataset->timestamp(2) - dataset->timestamp(0), 0.125, 1e-6);
  EXPECT_FALSE(dataset->ground_truth());
  const ByteImage left = dataset->load(0).left;
  ASSERT_EQ(left.channels(), 3);
  for (int x : {0, 31, 32}) {
    EXPECT_EQ(left.at(x, 20, 0), 10);
    EXPECT_EQ(left.at(x, 20, 1), 40);
    EXPECT_EQ(left.at(x, 20, 2), 200);
  }
  // One pixel to the right of where it was.
  cv::Mat marked(kHeight, kWidth, CV_8UC3, cv::Scalar::all(0));
  marked.at<cv::Vec3b>(20, 30) = {255, 255, 255};
  for (const char* side : {"left", "right"})
    test::write_mat(root() / drive_ / "stereo" / side / fmt::format("{}.png", time(0)), marked);
  EXPECT_EQ(open(drive_)->load(0).left.at(31, 20), 255);

  fs::remove_all(root() / drive_ / "stereo" / "left");
  const auto narrow = open(drive_);
  EXPECT_NEAR(narrow->camera().baseline, 0.119997, 1e-9);
  EXPECT_NE(narrow->notes().front().find("the narrow pair"), std::string::npos) << narrow->notes().front();
}

TEST_F(RobotCar, TruthIsCarriedFromTheInertialSensorToTheCamera) {
  // The vehicle is the stereo camera; the sensor is 2 m behind it and looks to the right.
  write(sdk_ / "extrinsics" / "stereo.txt", "0 0 0 0 0 0\n");
  write(sdk_ / "extrinsics" / "ins.txt", fmt::format("-2 0 0 0 0 {:.15f}\n", std::acos(0.0)));
  // The camera drives north at 16 m/s: the sensor points east. Every other frame has no pose of its own.
  std::string rows =
      "timestamp,ins_status,latitude,longitude,altitude,northing,easting,down,utm_zone,velocity_north,"
      "velocity_east,"
      "velocity_down,roll,pitch,yaw\n";
  for (int i = 0; i < 2; ++i)
    rows += fmt::format("{},INS_SOLUTION_GOOD,51.7,-1.2,113,{},620000,-110,30U,16,0,0,0,0,{:.15f}\n",
                        time(2 * i), 5735000.0 + 2.0 * i, std::acos(0.0));
  write(drive_ / "gps" / "ins.csv", rows);
  const auto dataset = open(drive_);
  ASSERT_TRUE(dataset->ground_truth());
  ASSERT_EQ(dataset->ground_truth()->size(), 3U);
  const SE3 step = dataset->ground_truth()->front().T_wc.inverse() * (*dataset->ground_truth())[1].T_wc;
  EXPECT_LT((step.translation - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 1e-6);
  EXPECT_LT(step.angle(), 1e-6);
  const SE3& T_ins_camera = mounting_of("ins", dataset->mountings(), "here").T_frame_camera;
  EXPECT_LT((T_ins_camera.translation - Eigen::Vector3d(0.0, -2.0, 0.0)).norm(), 1e-6);
  EXPECT_LT((T_ins_camera.rotation.col(2) + Eigen::Vector3d::UnitY()).norm(), 1e-6);

  // The odometry of the data set, of the vehicle: a step ahead.
  fs::remove_all(root() / drive_ / "gps");
  write(drive_ / "vo" / "vo.csv", fmt::format("source_timestamp,destination_timestamp,x,y,z,roll,pitch,yaw\n{"
                                              "},{},1,0,0,0,0,0\n{},{},1,0,0,0,0,0\n",
                                              time(1), time(0), time(2), time(1)));
  const auto by_odometry = open(drive_);
  ASSERT_TRUE(by_odometry->ground_truth());
  EXPECT_LT(((*by_odometry->ground_truth())[2].T_wc.translation - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(),
            1e-9);
  EXPECT_LT(((*by_odometry->ground_truth())[2].T_wc.rotation.col(2) - Eigen::Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_NE(by_odometry->notes().front().find("visual odometry"), std::string::npos);

  write(drive_ / "vo" / "vo.csv", "source_timestamp,x,y,z,roll,pitch,yaw\n1,2,3,4,5,6,7\n");
  expect_error<InputError>([&] { open(drive_); }, {"vo.csv:1", "a column destination_timestamp"});
  fs::remove_all(root() / sdk_ / "extrinsics");
  write(drive_ / "gps" / "ins.csv", rows);
  const auto without = open(drive_);
  EXPECT_FALSE(without->ground_truth());
  EXPECT_NE(without->notes().front().find("extrinsics/stereo.txt"), std::string::npos);
}

TEST_F(RobotCar, WhatIsMissingOfItsSdkIsNamed) {
  fs::rename(root() / sdk_ / "models", root() / drive_ / "models");  // found there, too
  EXPECT_EQ(open(drive_)->size(), 3);
  write(drive_ / "models/stereo_wide_left_distortion_lut.bin", "short");
  expect_error<InputError>([&] { open(drive_); },
                           {"stereo_wide_left_distortion_lut.bin", "76800 bytes", "80 x 60", "5 bytes"});
  write(drive_ / "models/stereo_wide_right.txt", "70 70 40 30 0\n0 0 1 0\n1 0 0 0.2\n0 1 0 0.3\n0 0 0 1\n");
  write(drive_ / "models/stereo_wide_left.txt", "70 70 40\n");
  expect_error<InputError>([&] { open(drive_); }, {"stereo_wide_left.txt:1", "4 numbers"});
  fs::remove_all(root() / drive_ / "models");
  expect_error<InputError>([&] { open(drive_); }, {"models/ of RobotCar's SDK", "robotcar-dataset-sdk"});
  fs::remove_all(root() / drive_ / "stereo");
  expect_error<InputError>([&] { open(drive_); }, {"RobotCar's layout without stereo/left"});
}

}  // namespace
}  // namespace penumbra::slam
