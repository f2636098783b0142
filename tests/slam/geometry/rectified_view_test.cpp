#include "slam/geometry/rectified_view.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "nn/base/counter_random.h"
#include "slam/geometry/rectification.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

constexpr double kSame = 1e-9;  // against OpenCV; pixels: 1000 times that

// Lenses around those of EuRoC's and TUM-VI's cameras.
LensCamera random_lens(LensModel model, std::uint64_t seed) {
  auto random = [seed, i = std::uint64_t{0}](double low, double high) mutable {
    return low + (high - low) * counter_uniform(seed, i++);
  };
  LensCamera c;
  c.model = model;
  c.width = 752;
  c.height = 480;
  c.fx = random(380.0, 480.0);
  c.fy = c.fx * random(0.99, 1.01);
  c.cx = random(340.0, 400.0);
  c.cy = random(220.0, 260.0);
  if (model == LensModel::equidistant) {
    c.fy = c.fx;  // OpenCV 4.6 scales the wrong coordinate where they differ; later ones do not
    c.distortion = {random(-0.03, 0.03), random(-0.01, 0.01), random(-0.01, 0.01), random(-0.002, 0.002)};
  } else {
    c.distortion = {random(-0.3, -0.1), random(0.02, 0.08), random(-1e-3, 1e-3), random(-1e-3, 1e-3)};
    if (seed % 2 == 0) c.distortion.push_back(random(-0.01, 0.01));
  }
  return c;
}

cv::Matx33d matrix_of(const LensCamera& c) { return {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}; }
cv::Matx33d to_cv(const Eigen::Matrix3d& m) {
  cv::Matx33d out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out(r, c) = m(r, c);
  return out;
}

void expect_same(const Eigen::Matrix3d& ours, const cv::Mat& theirs) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ours(r, c), theirs.at<double>(r, c), kSame);
}

void expect_same(const Pinhole& ours, const cv::Mat& P) {
  EXPECT_NEAR(ours.fx, P.at<double>(0, 0), 1e3 * kSame);
  EXPECT_NEAR(ours.fy, P.at<double>(1, 1), 1e3 * kSame);
  EXPECT_NEAR(ours.cx, P.at<double>(0, 2), 1e3 * kSame);
  EXPECT_NEAR(ours.cy, P.at<double>(1, 2), 1e3 * kSame);
}

// Pixels whose place is another float than OpenCV's, and the largest difference. Sums in another order differ
// by some 1e-13 pixels: now and then that makes the next float.
void expect_same_places(const LensCamera& lens, const Eigen::Matrix3d& turn, const Pinhole& view) {
  const cv::Size size(lens.width, lens.height);
  cv::Mat x, y, places, weights;
  const auto make = [&](auto function) {
    function(matrix_of(lens), lens.distortion, to_cv(turn), to_cv(view.matrix()), size, CV_32FC1, x, y);
  };
  if (lens.model == LensModel::equidistant) {
    make(cv::fisheye::initUndistortRectifyMap);
  } else {
    make(cv::initUndistortRectifyMap);
  }
  int others = 0;
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector3d ray = (view.matrix() * turn).inverse() * Eigen::Vector3d(u, v, 1.0);
      const Eigen::Vector2f place = pixel_of(lens, ray.hnormalized()).cast<float>();
      ASSERT_NEAR(place.x(), x.at<float>(v, u), 1e-4);
      ASSERT_NEAR(place.y(), y.at<float>(v, u), 1e-4);
      others += place.x() != x.at<float>(v, u) || place.y() != y.at<float>(v, u);
    }
  }
  EXPECT_LE(others, 4);
}

class RectifiedView : public testing::TestWithParam<LensModel> {};

TEST_P(RectifiedView, OfAPairIsOpenCvs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const LensCamera left = random_lens(GetParam(), seed), right = random_lens(GetParam(), seed + 100);
    const auto turn = [&](std::uint64_t i) { return 0.1 * (counter_uniform(seed, 50 + i) - 0.5); };
    const SE3 T{so3_exp({turn(0), turn(1), turn(2)}), {-0.11, 0.1 * turn(3), 0.1 * turn(4)}};
    const RectifyingTurns turns = rectifying_turns(T);
    const cv::Vec3d t(T.translation.x(), T.translation.y(), T.translation.z());
    const cv::Size size(left.width, left.height);
    cv::Mat R1, R2, P1, P2, Q;
    if (GetParam() == LensModel::equidistant) {
      cv::fisheye::stereoRectify(matrix_of(left), left.distortion, matrix_of(right), right.distortion, size,
                                 to_cv(T.rotation), t, R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, size, 0.0,
                                 1.0);
    } else {
      cv::stereoRectify(matrix_of(left), left.distortion, matrix_of(right), right.distortion, size,
                        to_cv(T.rotation), t, R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
    }
    expect_same(turns.left, R1);
    expect_same(turns.right, R2);
    const Pinhole view = rectified_view(left, right, turns);
    expect_same(view, P1);
    expect_same(view, P2);
    if (seed > 3) continue;
    expect_same_places(left, turns.left, view);
    expect_same_places(right, turns.right, view);
  }
}

TEST_P(RectifiedView, OfOneLensIsOpenCvs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const LensCamera lens = random_lens(GetParam(), seed);
    const cv::Size size(lens.width, lens.height);
    cv::Mat P;
    if (GetParam() == LensModel::equidistant) {
      cv::fisheye::estimateNewCameraMatrixForUndistortRectify(matrix_of(lens), lens.distortion, size,
                                                              cv::Matx33d::eye(), P, 0.0, size);
    } else {
      P = cv::getOptimalNewCameraMatrix(matrix_of(lens), lens.distortion, size, 0.0, size);
    }
    expect_same(rectified_view(lens), P);
  }
}

// A table made from our places moves an image as OpenCV's does.
TEST_P(RectifiedView, UndistortsAnImageAsOpenCvDoes) {
  const LensCamera lens = random_lens(GetParam(), 4);
  ByteImage image(lens.width, lens.height);
  for (std::size_t i = 0; i < image.elements(); ++i)
    image.data()[i] = static_cast<std::uint8_t>(counter_random(5, i));
  const Undistortion ours = undistort(lens, "test");
  const Pinhole view = rectified_view(lens);
  const cv::Size size(lens.width, lens.height);
  cv::Mat x, y, places, weights, theirs;
  if (GetParam() == LensModel::equidistant) {
    cv::fisheye::initUndistortRectifyMap(matrix_of(lens), lens.distortion, cv::Matx33d::eye(),
                                         to_cv(view.matrix()), size, CV_32FC1, x, y);
  } else {
    cv::initUndistortRectifyMap(matrix_of(lens), lens.distortion, cv::Matx33d::eye(), to_cv(view.matrix()),
                                size, CV_32FC1, x, y);
  }
  cv::convertMaps(x, y, places, weights, CV_16SC2, false);
  cv::remap(test::to_mat(image), theirs, places, weights, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const ByteImage out = ours.remap.linear(image);
  int others = 0;
  for (int v = 0; v < lens.height; ++v)
    for (int u = 0; u < lens.width; ++u) others += out.at(u, v) != theirs.at<std::uint8_t>(v, u);
  EXPECT_LE(others, 1);
}

INSTANTIATE_TEST_SUITE_P(Models, RectifiedView,
                         testing::Values(LensModel::radial_tangential, LensModel::equidistant));

TEST(Lens, DirectionsComeBack) {
  for (const LensModel model : {LensModel::radial_tangential, LensModel::equidistant}) {
    const LensCamera lens = random_lens(model, 8);
    for (const Eigen::Vector2d& d : {Eigen::Vector2d(0.0, 0.0), {0.1, -0.2}, {-0.3, 0.1}, {0.25, 0.25}}) {
      EXPECT_LT((direction_of(lens, pixel_of(lens, d)) - d).norm(),
                model == LensModel::equidistant ? 1e-12 : 2e-4);
    }
  }
}

TEST(Lens, EquidistantWithoutASolutionIsNoNumber) {
  LensCamera lens = random_lens(LensModel::equidistant, 8);
  lens.distortion = {-3.0, 0.0, 0.0, 0.0};
  EXPECT_FALSE(direction_of(lens, {740.0, 470.0}).allFinite());
}

}  // namespace
}  // namespace penumbra::slam
