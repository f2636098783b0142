// The same rig as each tool writes it gives the same cameras.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/sources/calibration/calibration.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

namespace fs = std::filesystem;

// EuRoC's, about.
CameraFile test_rig() {
  CameraFile rig;
  rig.rectified = false;
  rig.left = {458.654,
              457.296,
              367.215,
              248.375,
              LensModel::radial_tangential,
              {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05},
              752,
              480};
  rig.right = {457.587,
               456.134,
               379.999,
               255.238,
               LensModel::radial_tangential,
               {-0.28368365, 0.07451284, -0.00010473, -3.555907e-05},
               752,
               480};
  rig.T_right_left.rotation = (Eigen::AngleAxisd(0.014, Eigen::Vector3d::UnitX()) *
                               Eigen::AngleAxisd(-0.0023, Eigen::Vector3d::UnitZ()))
                                  .toRotationMatrix();
  rig.T_right_left.translation = {-0.110074, 0.000399, -0.000854};
  rig.place = "test";
  return rig;
}

std::string numbers(const std::vector<double>& values) { return fmt::format("{}", fmt::join(values, ", ")); }

// Row by row, with a last row where there are four.
std::string rows(const SE3& T, int count) {
  std::vector<double> values;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) values.push_back(T.rotation(row, column));
    values.push_back(T.translation[row]);
  }
  if (count == 4) values.insert(values.end(), {0.0, 0.0, 0.0, 1.0});
  return numbers(values);
}

std::string rotation(const Eigen::Matrix3d& R) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_row = R;
  return numbers({by_row.data(), by_row.data() + 9});
}

std::string matrix(const std::string& key, int row_count, int columns, const std::string& data,
                   const std::string& tag = "") {
  return fmt::format("{}:{}\n  rows: {}\n  cols: {}\n  data: [{}]\n", key, tag, row_count, columns, data);
}

std::string kalibr_lens(const LensCamera& c) {
  return fmt::format(
      "  camera_model: pinhole\n  intrinsics: [{}]\n  distortion_model: radtan\n  distortion_coeffs: [{}]\n"
      "  resolution: [752, 480]\n  cam_overlaps: [1]\n  rostopic: /cam/image_raw\n",
      numbers({c.fx, c.fy, c.cx, c.cy}), numbers(c.distortion));
}

std::string camera_matrix(const LensCamera& c) {
  return numbers({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0});
}

class Dialects : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& name, const std::string& text) const {
    nn::write_file(folder_ / name, text);
    return folder_ / name;
  }
  void expect_test_rig(const std::vector<fs::path>& files, const std::string& dialect) const {
    const Calibration read = read_calibration(files);
    EXPECT_EQ(read.dialect, dialect);
    const RecordedCamera expected = make_camera(test_rig()), found = make_camera(read.camera);
    EXPECT_NEAR(found.camera.fx, expected.camera.fx, 1e-6);
    EXPECT_NEAR(found.camera.cx, expected.camera.cx, 1e-6);
    EXPECT_NEAR(found.camera.cy, expected.camera.cy, 1e-6);
    EXPECT_NEAR(found.camera.baseline, expected.camera.baseline, 1e-9);
    EXPECT_LT((found.R_rectified_left - expected.R_rectified_left).norm(), 1e-9);
  }

 private:
  const fs::path folder_ = fs::temp_directory_path() / fmt::format("penumbra_dialects_{}", ::getpid());
};

const CameraFile kRig = test_rig();
const std::string kKalibrName = "Kalibr's camchain";

TEST_F(Dialects, KalibrsChain) {
  expect_test_rig({write("a.yaml", "cam0:\n" + kalibr_lens(kRig.left) + "cam1:\n  T_cn_cnm1: [" +
                                       rows(kRig.T_right_left, 4) + "]\n" + kalibr_lens(kRig.right))},
                  kKalibrName);
}

TEST_F(Dialects, KalibrsAndOpenVinssChainsThroughAnInertialSensor) {
  SE3 T_left_imu;
  T_left_imu.rotation =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  T_left_imu.translation = {0.1, -0.2, 0.05};
  const SE3 T_right_imu = kRig.T_right_left * T_left_imu;
  const auto chain = [&](const char* key, const SE3& left, const SE3& right) {
    return fmt::format("%YAML:1.0\ncam0:\n  {0}: [{1}]\n{2}cam1:\n  {0}: [{3}]\n{4}", key, rows(left, 4),
                       kalibr_lens(kRig.left), rows(right, 4), kalibr_lens(kRig.right));
  };
  const fs::path kalibr = write("kalibr.yaml", chain("T_cam_imu", T_left_imu, T_right_imu)),
                 openvins =
                     write("openvins.yaml", chain("T_imu_cam", T_left_imu.inverse(), T_right_imu.inverse()));
  for (const fs::path& file : {kalibr, openvins}) {
    expect_test_rig({file}, kKalibrName);
    const CameraFile read = read_camera_file(file);
    EXPECT_LT((mounting_of("imu", read.mountings, "here").T_frame_camera * T_left_imu).log().norm(), 1e-9);
    // What is written in our own keys keeps it, and rectifying turns it.
    const CameraFile again = read_camera_file(write("again.yaml", calibration_text(read)));
    const RecordedCamera made = make_camera(again);
    const SE3 T_imu_left = mounting_of("imu", made.mountings, "here").T_frame_camera *
                           SE3{made.R_rectified_left, Eigen::Vector3d::Zero()};
    EXPECT_LT((T_imu_left * T_left_imu).log().norm(), 1e-9);
    EXPECT_GT((made.R_rectified_left - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  }
}

TEST_F(Dialects, OrbSlam3OfRawImages) {
  std::string text = "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n";
  int number = 1;
  for (const LensCamera& c : {kRig.left, kRig.right}) {
    text += fmt::format("Camera{0}.fx: {1}\nCamera{0}.fy: {2}\nCamera{0}.cx: {3}\nCamera{0}.cy: {4}\n",
                        number, c.fx, c.fy, c.cx, c.cy);
    text += fmt::format("Camera{0}.k1: {1}\nCamera{0}.k2: {2}\nCamera{0}.p1: {3}\nCamera{0}.p2: {4}\n",
                        number, c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3]);
    ++number;
  }
  text += "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20\nORBextractor.nFeatures: 1200\n" +
          matrix("Stereo.T_c1_c2", 4, 4, rows(kRig.T_right_left.inverse(), 4), " !!opencv-matrix");
  const fs::path file = write("orb.yaml", text);
  expect_test_rig({file}, "ORB-SLAM's settings");
  EXPECT_EQ(read_camera_file(file).frame_rate, 20.0);
}

TEST_F(Dialects, OrbSlam2OfRectifiedPairsAndCamerasWithDepth) {
  const std::string lens =
      "Camera.fx: 500\nCamera.fy: 500\nCamera.cx: 320\nCamera.cy: 240\nCamera.k1: 0.0\n"
      "Camera.k2: 0.0\nCamera.p1: 0.0\nCamera.p2: 0.0\nCamera.bf: 40\n";
  const CameraFile pair = read_camera_file(write("pair.yaml", "%YAML:1.0\n" + lens));
  EXPECT_TRUE(pair.rectified);
  EXPECT_NEAR(pair.baseline, 0.08, 1e-12);
  const CameraFile depth =
      read_camera_file(write("depth.yaml", "%YAML:1.0\n" + lens + "DepthMapFactor: 5000\n"));
  EXPECT_EQ(depth.sensor, Sensor::rgbd);
  EXPECT_EQ(depth.depth_factor, 5000.0);
}

// What rectifies a rig by hand: both cameras turned so that their rows lie along the baseline.
struct ByHand {
  Eigen::Matrix3d R_left, R_right;
  double baseline = 0.0;
};
ByHand rectify_by_hand(const SE3& T_right_left) {
  const Eigen::Vector3d base = T_right_left.inverse().translation, x = base.normalized(),
                        y = Eigen::Vector3d::UnitZ().cross(x).normalized();
  ByHand made;
  made.baseline = base.norm();
  made.R_left << x.transpose(), y.transpose(), x.cross(y).transpose();
  made.R_right = made.R_left * T_right_left.rotation.transpose();
  return made;
}

TEST_F(Dialects, OrbSlam2AndRosOfRawImages) {
  const ByHand by_hand = rectify_by_hand(kRig.T_right_left);
  const auto P = [&](double base) {
    return numbers({435.0, 0.0, 367.0, -435.0 * base, 0.0, 435.0, 252.0, 0.0, 0.0, 0.0, 1.0, 0.0});
  };
  std::string orb =
      "%YAML:1.0\nCamera.fx: 435\nCamera.fy: 435\nCamera.cx: 367\nCamera.cy: 252\nCamera.bf: 47.9\n";
  std::vector<fs::path> ros;
  for (const bool right : {false, true}) {
    const LensCamera& c = right ? kRig.right : kRig.left;
    const Eigen::Matrix3d& R = right ? by_hand.R_right : by_hand.R_left;
    const std::string p = P(right ? by_hand.baseline : 0.0), side = right ? "RIGHT." : "LEFT.";
    orb += side + "width: 752\n" + side + "height: 480\n" + matrix(side + "D", 1, 4, numbers(c.distortion)) +
           matrix(side + "K", 3, 3, camera_matrix(c)) + matrix(side + "R", 3, 3, rotation(R)) +
           matrix(side + "P", 3, 4, p);
    ros.push_back(
        write(right ? "right.yaml" : "left.yaml",
              "image_width: 752\nimage_height: 480\ncamera_name: c\n" +
                  matrix("camera_matrix", 3, 3, camera_matrix(c)) + "distortion_model: plumb_bob\n" +
                  matrix("distortion_coefficients", 1, 5, numbers(c.distortion) + ", 0") +
                  matrix("rectification_matrix", 3, 3, rotation(R)) + matrix("projection_matrix", 3, 4, p)));
  }
  expect_test_rig({write("orb.yaml", orb)}, "ORB-SLAM's settings");
  expect_test_rig(ros, "ROS's camera_info");
  std::swap(ros[0], ros[1]);
  test::expect_error<InputError>([&] { read_calibration(ros); }, {"are left and right exchanged?"});
}

TEST_F(Dialects, OpencvsStorageUnderItsUsualNames) {
  const std::string tag = " !!opencv-matrix";
  const auto storage = [&](const std::string& K, const std::string& D) {
    return "%YAML:1.0\n---\nimage_width: 752\nimage_height: 480\n" +
           matrix(K + "1", 3, 3, camera_matrix(kRig.left), tag) +
           matrix(D + "1", 1, 5, numbers(kRig.left.distortion) + ", 0.", tag) +
           matrix(K + "2", 3, 3, camera_matrix(kRig.right), tag) +
           matrix(D + "2", 1, 5, numbers(kRig.right.distortion) + ", 0.", tag) +
           matrix("R", 3, 3, rotation(kRig.T_right_left.rotation), tag) +
           matrix("T", 3, 1,
                  numbers({kRig.T_right_left.translation.data(), kRig.T_right_left.translation.data() + 3}),
                  tag);
  };
  const std::string name = "OpenCV's FileStorage of stereoCalibrate";
  expect_test_rig({write("K.yml", storage("K", "D"))}, name);
  expect_test_rig({write("M.yml", storage("M", "D"))}, name);
  expect_test_rig({write("c.yml", storage("cameraMatrix", "distCoeffs"))}, name);
}

TEST_F(Dialects, OpencvsRationalModelIsWrittenBack) {
  const std::vector<double> all = {0.1,    0.02,   0.001,   -0.001, 0.003,  0.2,  0.01,
                                   0.0015, 0.0005, -0.0003, 0.0002, 0.0001, 0.02, -0.01};
  const auto storage = [&](std::size_t count) {
    std::string text;
    for (const char* side : {"1", "2"}) {
      text += matrix(fmt::format("K{}", side), 3, 3, camera_matrix(kRig.left)) +
              matrix(fmt::format("D{}", side), 1, static_cast<int>(count),
                     numbers({all.data(), all.data() + count}));
    }
    text += matrix("R", 3, 3, rotation(Eigen::Matrix3d::Identity())) + matrix("T", 3, 1, "-0.1, 0, 0") +
            "image_width: 752\nimage_height: 480\n";
    return write("rational.yml", text);
  };
  for (const std::size_t count : {8U, 12U, 14U}) {
    const CameraFile read = read_camera_file(storage(count));
    EXPECT_EQ(read.left.distortion.size(), count);
    const CameraFile again = read_camera_file(write("ours.yaml", calibration_text(read)));
    EXPECT_EQ(again.left.distortion, read.left.distortion);
  }
  for (const std::size_t count : {9U, 10U, 13U})
    test::expect_error<InputError>([&] { read_camera_file(storage(count)); }, {"8, 12 or 14 coefficients"});
}

TEST_F(Dialects, SensorYamlOfBothCameras) {
  const auto sensor = [&](const LensCamera& c, const SE3& T_BS) {
    return matrix("T_BS", 4, 4, rows(T_BS, 4)) +
           fmt::format(
               "resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [{}]\n"
               "distortion_model: radial-tangential\ndistortion_coefficients: [{}]\n",
               numbers({c.fx, c.fy, c.cx, c.cy}), numbers(c.distortion));
  };
  SE3 T_body_left;
  T_body_left.translation = {0.3, 0.1, -0.2};
  const fs::path left = write("left.yaml", sensor(kRig.left, T_body_left)),
                 right = write("right.yaml", sensor(kRig.right, T_body_left * kRig.T_right_left.inverse()));
  expect_test_rig({left, right}, "a sensor.yaml of EuRoC or TUM-VI");
  const std::vector<Mounting> mountings = read_calibration({left, right}).camera.mountings;
  EXPECT_EQ(mounting_of("body", mountings, "here").T_frame_camera.translation, T_body_left.translation);
  test::expect_error<InputError>([&] { read_calibration({left}); }, {"the sensor.yaml of both cameras"});
}

TEST_F(Dialects, OursReadsBackWhatItWrites) {
  expect_test_rig({write("ours.yaml", calibration_text(kRig))}, "Penumbra");
  CameraFile depth;
  depth.sensor = Sensor::rgbd;
  depth.left = {517.3, 516.5, 318.6, 255.3, LensModel::radial_tangential, {0.26, -0.95, -0.005, 0.002, 1.16},
                640,   480};
  depth.baseline = 0.075;
  depth.frame_rate = 30.0;
  const CameraFile again = read_camera_file(write("depth.yaml", calibration_text(depth)));
  EXPECT_EQ(again.sensor, Sensor::rgbd);
  EXPECT_EQ(again.left.distortion, depth.left.distortion);
  EXPECT_EQ(again.depth_factor, depth.depth_factor);
  EXPECT_EQ(again.frame_rate, depth.frame_rate);
  EXPECT_TRUE(again.mountings.empty());
  const std::string on_a_robot = calibration_text(depth) + "body: base_link\n";
  for (const char* key : {"T_body_left: [1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 2]",
                          "T_left_body: [1, 0, 0, -0.5, 0, 1, 0, 0, 0, 0, 1, -2]"}) {
    const CameraFile read = read_camera_file(write("robot.yaml", on_a_robot + key + "\n"));
    EXPECT_EQ(mounting_of("base_link", read.mountings, "here").T_frame_camera.translation,
              Eigen::Vector3d(0.5, 0.0, 2.0));
  }
  test::expect_error<InputError>([&] { read_camera_file(write("nowhere.yaml", on_a_robot)); },
                                 {"T_body_left"});
}

TEST_F(Dialects, BasaltsJson) {
  const SE3 T_left_right = kRig.T_right_left.inverse();
  const Eigen::Quaterniond q(T_left_right.rotation);
  const auto camera = [](const char* type) {
    return fmt::format(
        R"({{"camera_type": "{}", "intrinsics": {{"fx": 300, "fy": 301, "cx": 320, "cy": 240, )"
        R"("k1": 0.01, "k2": 0.002, "k3": -0.003, "k4": 0.0004}}}})",
        type);
  };
  const auto file = [&](const char* type) {
    return fmt::format(
        R"({{"value0": {{"T_imu_cam": [{{"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}}, )"
        R"({{"px": {}, "py": {}, "pz": {}, "qx": {}, "qy": {}, "qz": {}, "qw": {}}}], )"
        R"("intrinsics": [{}, {}], "resolution": [[640, 480], [640, 480]]}}}})",
        T_left_right.translation.x(), T_left_right.translation.y(), T_left_right.translation.z(), q.x(),
        q.y(), q.z(), q.w(), camera("kb4"), camera(type));
  };
  const Calibration read = read_calibration({write("basalt.json", file("kb4"))});
  EXPECT_EQ(read.dialect, "Basalt");
  EXPECT_EQ(read.camera.right.model, LensModel::equidistant);
  EXPECT_EQ(read.camera.right.distortion, (std::vector<double>{0.01, 0.002, -0.003, 0.0004}));
  EXPECT_LT((read.camera.T_right_left.rotation - kRig.T_right_left.rotation).norm(), 1e-9);
  EXPECT_LT((read.camera.T_right_left.translation - kRig.T_right_left.translation).norm(), 1e-9);
  test::expect_error<InputError>([&] { read_calibration({write("ds.json", file("ds"))}); },
                                 {"expected kb4 or pinhole"});
  test::expect_error<InputError>([&] { read_calibration({write("torn.json", "{\"T_imu_cam\": [")}); },
                                 {"expected JSON"});
}

TEST_F(Dialects, Eth3dsLine) {
  const CameraFile camera = read_camera_file(write("calibration.txt", "726.28 726.3 354.6 186.4\n"));
  EXPECT_EQ(camera.sensor, Sensor::rgbd);
  EXPECT_EQ(camera.left.fy, 726.3);
  test::expect_error<InputError>([&] { read_camera_file(write("short.txt", "726.28 726.3 354.6\n")); },
                                 {"expected fx fy cx cy"});
}

TEST_F(Dialects, WhatIsMissingIsNamed) {
  const auto expect = [&](const std::string& text, const std::string& message) {
    test::expect_error<InputError>([&] { read_calibration({write("bad.yaml", text)}); }, {message});
  };
  expect("cam0:\n" + kalibr_lens(kRig.left) + "cam1:\n" + kalibr_lens(kRig.right), "cam1's T_cn_cnm1");
  expect("cam0:\n  camera_model: omni\n  intrinsics: [1, 1, 1, 1]\n", "expected pinhole");
  expect("Camera1.fx: 500\nCamera1.fy: 500\nCamera1.cx: 320\nCamera1.cy: 240\n", "one camera without depth");
  expect("Camera1.fx: 500\n", "the key Camera1.fy");
  test::expect_error<InputError>(
      [&] {
        read_calibration({write("a.yaml", "fx: 1\n"), write("b.yaml", "fx: 1\n")});
      },
      {"two files of ROS's camera_info"});
}

}  // namespace
}  // namespace penumbra::slam
