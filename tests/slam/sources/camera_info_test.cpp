// Cameras as drivers describe them, to the cameras of the rectified images.
#include "slam/sources/camera_info.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "nn/base/error.h"
#include "tests/support/bag_files.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using test::CameraParts;
using test::expect_error;
using test::pinhole;

CameraInfoMessage message(const CameraParts& parts) {
  return read_camera_info(test::camera_message(test::Wire::ros1, parts), MessageEncoding::ros1, "/info");
}

TEST(CameraInfo, RectifiedPairsAreThoseOfP) {
  CameraParts left = pinhole(640, 480, 500), right = pinhole(640, 480, 500, -60);
  // By the name, whatever K and D of the raw images are.
  left.K[0] = right.K[0] = 480;
  left.D = right.D = {0.1, 0.2, 0, 0, 0};
  right.P[2] = 318;  // stereoRectify without zero disparity
  const CameraInfoMessage l = message(left), r = message(right);
  const RecordedCamera camera = stereo_camera({l, "/left"}, {r, "/right"}, true);
  EXPECT_EQ(camera.camera.fx, 500.0);
  EXPECT_EQ(camera.camera.cx, 320.0);
  EXPECT_DOUBLE_EQ(camera.camera.baseline, 0.12);
  EXPECT_EQ(camera.camera.disparity_offset, 2.0);
  EXPECT_EQ(camera.camera.width, 640);
  EXPECT_TRUE(camera.left.is_identity());
}

TEST(CameraInfo, WhereThereIsNothingToRectifyPIsTaken) {
  const CameraInfoMessage l = message(pinhole(640, 480, 500)), r = message(pinhole(640, 480, 500, -50));
  const RecordedCamera camera = stereo_camera({l, "/left"}, {r, "/right"}, false);
  EXPECT_TRUE(camera.left.is_identity());
  EXPECT_TRUE(camera.right.is_identity());
  EXPECT_DOUBLE_EQ(camera.camera.baseline, 0.1);
}

// EuRoC's rig, as stereoRectify makes CameraInfos of it, gives what its own calibration gives.
TEST(CameraInfo, RawPairsAreRectifiedByWhatBothSay) {
  const cv::Matx33d K_left(458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1);
  const cv::Matx33d K_right(457.587, 0, 379.999, 0, 456.134, 255.238, 0, 0, 1);
  const std::vector<double> D_left = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0};
  const std::vector<double> D_right = {-0.28368365, 0.07451284, -0.00010473, -3.555907e-05, 0.0};
  const cv::Matx33d R(0.999997256, 0.002312067, 0.000376008, -0.002317136, 0.999898049, 0.014089836,
                      -0.000343393, -0.014090668, 0.999900663);
  const cv::Vec3d t(-0.110073808, 0.000399122, -0.000853703);
  cv::Matx33d R_left, R_right;
  cv::Matx34d P_left, P_right;
  cv::Matx44d Q;
  cv::stereoRectify(K_left, D_left, K_right, D_right, cv::Size(752, 480), R, t, R_left, R_right, P_left,
                    P_right, Q);
  const auto parts = [](const cv::Matx33d& K, const std::vector<double>& D, const cv::Matx33d& turn,
                        const cv::Matx34d& P) {
    CameraParts camera;
    camera.width = 752;
    camera.height = 480;
    camera.D = D;
    std::copy_n(K.val, 9, camera.K.begin());
    std::copy_n(turn.val, 9, camera.R.begin());
    std::copy_n(P.val, 12, camera.P.begin());
    return camera;
  };
  const CameraInfoMessage l = message(parts(K_left, D_left, R_left, P_left));
  const CameraInfoMessage r = message(parts(K_right, D_right, R_right, P_right));
  const RecordedCamera camera = stereo_camera({l, "/left"}, {r, "/right"}, false);

  CameraFile file;
  file.rectified = false;
  file.left = {K_left(0, 0), K_left(1, 1), K_left(0, 2), K_left(1, 2), LensModel::radial_tangential,
               D_left,       752,          480};
  file.right = {K_right(0, 0),
                K_right(1, 1),
                K_right(0, 2),
                K_right(1, 2),
                LensModel::radial_tangential,
                D_right,
                752,
                480};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) file.T_right_left.rotation(row, column) = R(row, column);
    file.T_right_left.translation[row] = t[row];
  }
  const RecordedCamera direct = make_camera(file);
  EXPECT_NEAR(camera.camera.fx, direct.camera.fx, 1e-4);
  EXPECT_NEAR(camera.camera.cx, direct.camera.cx, 1e-4);
  EXPECT_NEAR(camera.camera.cy, direct.camera.cy, 1e-4);
  EXPECT_NEAR(camera.camera.baseline, direct.camera.baseline, 1e-9);
  EXPECT_FALSE(camera.left.is_identity());
}

TEST(CameraInfo, TheRationalModelIsOpenCvs) {
  LensCamera lens{
      600, 610, 320, 240, LensModel::radial_tangential, {0.5, -0.2, 1e-3, -2e-3, 0.05, 0.8, -0.1, 0.02},
      640, 480};
  std::vector<cv::Point2d> pixels;
  const std::vector<cv::Point3d> points = {{0.1, 0.2, 1}, {-0.4, 0.3, 1}, {0.5, -0.35, 1}, {0, 0, 1}};
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0),
                    cv::Matx33d(600, 0, 320, 0, 610, 240, 0, 0, 1), lens.distortion, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d pixel = pixel_of(lens, {points[i].x, points[i].y});
    EXPECT_NEAR(pixel.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(pixel.y(), pixels[i].y, 1e-9);
  }
  CameraParts parts = pinhole(640, 480, 600);
  parts.D = lens.distortion;
  parts.model = "rational_polynomial";
  const CameraInfoMessage info = message(parts);
  EXPECT_FALSE(rgbd_camera({info, "/colour"}, false).left.is_identity());
}

TEST(CameraInfo, BinningAndRegionOfInterestAreThoseOfTheImage) {
  CameraParts parts = pinhole(1280, 960, 1000);
  parts.binning_and_roi = {2, 2, 100, 60, 800, 1000};  // x 100, y 60; 1000 x 800
  const CameraInfoMessage info = message(parts);
  for (const bool is_rectified : {false, true}) {
    const StereoCamera camera = rgbd_camera({info, "/colour"}, is_rectified).camera;
    EXPECT_EQ(camera.width, 500);
    EXPECT_EQ(camera.height, 400);
    EXPECT_EQ(camera.fx, 500.0);
    EXPECT_EQ(camera.cx, 270.0);
    EXPECT_EQ(camera.cy, 210.0);
    EXPECT_EQ(camera.baseline, kNominalBaseline);
  }
}

TEST(CameraInfo, DepthCamerasAreThoseOfKWherePIsZeros) {
  CameraParts parts = pinhole(640, 480, 500);
  parts.P = {};
  parts.D = {0, 0, 0, 0, 0};
  const CameraInfoMessage plain = message(parts);
  EXPECT_EQ(rgbd_camera({plain, "/colour"}, true).camera.fx, 500.0);
  EXPECT_TRUE(rgbd_camera({plain, "/colour"}, false).left.is_identity());
  parts.D = {0.1, 0, 0, 0};
  parts.model = "equidistant";
  const CameraInfoMessage bent = message(parts);
  EXPECT_FALSE(rgbd_camera({bent, "/colour"}, false).left.is_identity());
  expect_error<InputError>([&] { rgbd_camera({bent, "/colour"}, true); }, {"/colour", "P", "zeros"});
}

TEST(CameraInfo, WhatIsNoCameraIsRefusedByName) {
  const CameraParts good_left = pinhole(640, 480, 500), good_right = pinhole(640, 480, 500, -60);
  const auto refused = [&](const CameraParts& left, const CameraParts& right, bool is_rectified,
                           std::initializer_list<std::string> parts) {
    const CameraInfoMessage l = message(left), r = message(right);
    expect_error<InputError>([&] { stereo_camera({l, "/left"}, {r, "/right"}, is_rectified); }, parts);
  };
  CameraParts zeros = good_right;
  zeros.P = {};
  refused(good_left, zeros, true, {"/right", "P[3] = -fx b", "zeros", "--camera"});
  refused(good_left, good_left, true, {"/right", "P[3] = 0", "--camera"});
  refused(good_right, good_left, true, {"/right", "swapped"});
  CameraParts above = good_right;
  above.P[7] = -30;
  refused(good_left, above, true, {"/right", "P[7]"});
  CameraParts longer = good_right;
  longer.P[0] = 510;
  refused(good_left, longer, true, {"/right", "500", "510"});
  CameraParts uncalibrated = good_left;
  uncalibrated.P = uncalibrated.P;
  uncalibrated.P[0] = 0;
  refused(uncalibrated, good_right, true, {"/left", "calibrated"});
  CameraParts turned = good_left;
  turned.D = {0.1, 0, 0, 0, 0};
  turned.R = {};
  refused(turned, good_right, false, {"/left", "rotation R"});
  CameraParts strange = good_left;
  strange.D = {0.1, 0, 0, 0, 0};
  strange.model = "inverse_brown_conrady";
  refused(strange, good_right, false, {"/left: D", "distortion model", "inverse_brown_conrady"});
  strange.model = "plumb_bob";
  strange.D[1] = std::nan("");
  refused(strange, good_right, false, {"/left", "finite"});
}

TEST(CameraInfo, NamesSayWhetherImagesAreRectified) {
  for (const char* name :
       {"/left/image_rect", "/zed/left/image_rect_color", "/infra1/image_rect_raw", "/rectified/left"})
    EXPECT_TRUE(says_rectified(name)) << name;
  for (const char* name : {"/left/image_raw", "/direct/image", "/cam0/image_color", "/rectangle/image"})
    EXPECT_FALSE(says_rectified(name)) << name;
}

}  // namespace
}  // namespace penumbra::slam
