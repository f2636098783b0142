#include "slam/frontend/locating/feature_refiner.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

class FeatureRefinerTest : public ::testing::Test {
 protected:
  FeatureRefinerTest() {
    cv::Mat image = test::textured_image(640, 480, 9);
    cv::GaussianBlur(image, image, cv::Size(7, 7), 1.5);
    image_ = image;
    pyramid_.build(test::byte_image(image_), settings_);
  }

  cv::Mat image_;
  PyramidSettings settings_;
  ImagePyramid pyramid_;
  std::vector<double> scales_ = level_scales(settings_);
  FeaturePixel pixel_{300.0F, 200.0F, 280.0F};
  static constexpr int kLevel = 2;
};

TEST_F(FeatureRefinerTest, MovesAFeatureToWhereThePatchIs) {
  const Patch patch = extract_patch(pyramid_, {301.1F, 200.6F, 2, 0.0F, 1.0F});
  const FeatureRefiner refiner(pyramid_, scales_);
  ASSERT_TRUE(refiner.refine(pixel_, kLevel, patch, 10.0, {300.0, 201.0}, 10.0));
  EXPECT_NEAR(pixel_.u, 301.1, 0.05);
  EXPECT_NEAR(pixel_.v, 200.6, 0.05);
  // The disparity is what was measured.
  EXPECT_NEAR(pixel_.u - pixel_.u_right, 20.0, 1e-3);
}

// The camera has come nearer by half: the patch is 1.5 times as large, which is between levels 4 and 5.
TEST_F(FeatureRefinerTest, FindsThePatchOfANearerPoint) {
  cv::Mat nearer;
  const cv::Mat zoom = (cv::Mat_<double>(2, 3) << 1.5, 0, -0.5 * 300, 0, 1.5, -0.5 * 200);
  cv::warpAffine(image_, nearer, zoom, image_.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  ImagePyramid pyramid;
  pyramid.build(test::byte_image(nearer), settings_);
  const Patch patch = extract_patch(pyramid_, {300.4F, 199.8F, 2, 0.0F, 1.0F});
  const FeatureRefiner refiner(pyramid, scales_);
  ASSERT_TRUE(refiner.refine(pixel_, kLevel, patch, 15.0, {300.0, 200.0}, 10.0));
  EXPECT_NEAR(pixel_.u, 300.6, 0.15);
  EXPECT_NEAR(pixel_.v, 199.7, 0.15);
}

TEST_F(FeatureRefinerTest, LeavesAFeatureWhereItIsWhenThePatchIsNot) {
  const Patch patch = extract_patch(pyramid_, {500.0F, 100.0F, 2, 0.0F, 1.0F});
  const FeatureRefiner refiner(pyramid_, scales_);
  const FeaturePixel before = pixel_;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, 10.0, {300.0, 200.0}, 10.0)) << "another place";
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, 10.0, {500.0, 100.0}, 10.0)) << "far from the feature";
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, 10.0, {300.0, 200.0}, 0.5)) << "much larger";
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, 10.0, {300.0, 200.0}, 1e9)) << "much smaller";
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, kNaN, {300.0, 200.0}, 10.0));
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, 10.0, {kNaN, 200.0}, 10.0));
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, patch, 10.0, {300.0, 200.0}, kNaN));
  EXPECT_FALSE(refiner.refine(pixel_, kLevel, {}, 10.0, {300.0, 200.0}, 10.0)) << "no patch";
  const ImagePyramid none;
  EXPECT_FALSE(FeatureRefiner(none, scales_).refine(pixel_, kLevel, patch, 10.0, {300.0, 200.0}, 10.0));
  EXPECT_EQ(pixel_.u, before.u);
  EXPECT_EQ(pixel_.u_right, before.u_right);
}

}  // namespace
}  // namespace penumbra::slam
