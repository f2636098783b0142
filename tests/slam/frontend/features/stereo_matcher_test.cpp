#include "slam/frontend/features/stereo_matcher.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "slam/frontend/features/orb_extractor.h"
#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

struct Pair {
  OrbExtractor left{OrbSettings{}}, right{OrbSettings{}};
  Features left_features, right_features;
  StereoMatches matches;

  Pair(const StereoCamera& camera, const cv::Mat& left_image, const cv::Mat& right_image) {
    left.extract(test::byte_image(left_image), left_features);
    right.extract(test::byte_image(right_image), right_features);
    match_stereo(camera, left_features, right_features, left.pyramid(), right.pyramid(), matches);
  }
};

StereoCamera small_camera() {
  StereoCamera camera = test::test_camera();
  camera.width = 640;
  camera.height = 240;
  return camera;
}

TEST(StereoMatcher, MeasuresAShiftToAFractionOfAPixel) {
  const StereoCamera camera = small_camera();
  for (const double shift : {7.0, 12.3, 20.5, 33.75}) {
    const cv::Mat left = test::textured_image(640, 240, 3);
    cv::Mat right;
    const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, -shift, 0, 1, 0);
    cv::warpAffine(left, right, move, left.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    const Pair pair(camera, left, right);
    ASSERT_GT(pair.matches.count, pair.left_features.size() / 2) << "shift " << shift;
    int close = 0;
    for (std::size_t i = 0; i < pair.matches.u_right.size(); ++i) {
      if (pair.matches.u_right[i] < 0.0F) {
        EXPECT_EQ(pair.matches.depth[i], -1.0F);
        continue;
      }
      const double disparity = pair.left_features.keypoints[i].u - pair.matches.u_right[i];
      const double scale = pair.left.pyramid().scale_x(pair.left_features.keypoints[i].level);
      close += std::abs(disparity - shift) < 0.25 * scale;
      EXPECT_NEAR(pair.matches.depth[i], camera.fx * camera.baseline / disparity, 0.01);
    }
    EXPECT_GT(close, 0.95 * pair.matches.count) << "shift " << shift;
  }
}

TEST(StereoMatcher, FindsNothingWhereTheCamerasAreSwapped) {
  // Left and right exchanged: every disparity would be negative.
  const cv::Mat left = test::textured_image(640, 240, 4);
  cv::Mat right;
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, 15.0, 0, 1, 0);
  cv::warpAffine(left, right, move, left.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  const Pair pair(small_camera(), left, right);
  // On random texture some chance pairs remain.
  EXPECT_LT(pair.matches.count, pair.left_features.size() / 10);
}

TEST(StereoMatcher, TakesABlackImageOnEitherSide) {
  const cv::Mat textured = test::textured_image(640, 240, 5), black = cv::Mat::zeros(240, 640, CV_8U);
  EXPECT_EQ(Pair(small_camera(), textured, black).matches.count, 0);
  EXPECT_EQ(Pair(small_camera(), black, textured).matches.count, 0);
  EXPECT_EQ(Pair(small_camera(), black, black).matches.count, 0);
}

}  // namespace
}  // namespace penumbra::slam
