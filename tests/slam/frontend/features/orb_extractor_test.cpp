#include "slam/frontend/features/orb_extractor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "nn/base/counter_random.h"
#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/orb_pattern.h"
#include "slam/frontend/features/quadtree.h"
#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

TEST(OrbExtractor, FindsAboutAsManyFeaturesAsWantedAndSpreadsThem) {
  const cv::Mat image = test::textured_image(640, 240, 1);
  OrbSettings settings;
  settings.features = 1000;
  OrbExtractor extractor(settings);
  Features features;
  extractor.extract(test::byte_image(image), features);
  EXPECT_GT(features.size(), 900);
  EXPECT_LT(features.size(), 1300);
  ASSERT_EQ(features.descriptors.size(), features.keypoints.size());
  // Every part of the image has some.
  cv::Mat1i cells = cv::Mat1i::zeros(3, 8);
  for (const Keypoint& k : features.keypoints) {
    ASSERT_GE(k.u, 0.0F);
    ASSERT_LE(k.u, 639.0F);
    ASSERT_GE(k.v, 0.0F);
    ASSERT_LE(k.v, 239.0F);
    ++cells(std::min(2, static_cast<int>(k.v) / 80), std::min(7, static_cast<int>(k.u) / 80));
  }
  double least = 0.0;
  cv::minMaxLoc(cells, &least);
  EXPECT_GE(least, 10.0);
}

TEST(OrbExtractor, DescriptorsSurviveARotationOfTheImage) {
  const cv::Mat image = test::textured_image(400, 400, 2);
  OrbExtractor extractor(OrbSettings{});
  Features straight, turned;
  extractor.extract(test::byte_image(image), straight);
  const double angle = 37.0;
  const cv::Mat turn = cv::getRotationMatrix2D({199.5F, 199.5F}, angle, 1.0);
  cv::Mat turned_image;
  cv::warpAffine(image, turned_image, turn, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  extractor.extract(test::byte_image(turned_image), turned);
  int right = 0;
  const std::vector<Match> matches = match_descriptors(straight.descriptors, turned.descriptors, {});
  for (const Match& m : matches) {
    const Keypoint &a = straight.keypoints[std::size_t(m.source)],
                   &b = turned.keypoints[std::size_t(m.feature)];
    const double u = turn.at<double>(0, 0) * a.u + turn.at<double>(0, 1) * a.v + turn.at<double>(0, 2);
    const double v = turn.at<double>(1, 0) * a.u + turn.at<double>(1, 1) * a.v + turn.at<double>(1, 2);
    right += std::hypot(u - b.u, v - b.v) < 4.0;
  }
  EXPECT_GT(matches.size(), 100U);
  EXPECT_GT(right, 0.9 * static_cast<double>(matches.size()));
}

TEST(OrbExtractor, PositionsDoNotDependOnTheLevel) {
  // A white disc: its corners' centre is the disc's centre on every level, half pixels included.
  cv::Mat image(400, 400, CV_8U, cv::Scalar(20));
  cv::circle(image, {200, 200}, 6, cv::Scalar(230), -1);
  cv::GaussianBlur(image, image, {0, 0}, 1.0);
  ImagePyramid pyramid;
  pyramid.build(test::byte_image(image), PyramidSettings{});
  for (int l = 0; l < pyramid.levels(); ++l) {
    const cv::Moments m = cv::moments(test::to_mat(pyramid.level(l)) - 20);
    const Eigen::Vector2f centre(static_cast<float>(m.m10 / m.m00), static_cast<float>(m.m01 / m.m00));
    const Eigen::Vector2f full = pyramid.to_full(centre, l);
    EXPECT_NEAR(full.x(), 200.0F, 0.15F) << "level " << l;
    EXPECT_NEAR(full.y(), 200.0F, 0.15F) << "level " << l;
    EXPECT_LT((pyramid.to_level(full, l) - centre).norm(), 1e-3F);
  }
}

TEST(OrbExtractor, ImagesWithoutTextureAndTinyImagesHaveNoFeatures) {
  OrbExtractor extractor(OrbSettings{});
  Features features;
  for (const Size& size : {Size{640, 480}, {33, 33}, {32, 200}, {1, 1}}) {
    extractor.extract(ByteImage::filled(size.width, size.height, 0), features);
    EXPECT_EQ(features.size(), 0);
  }
  extractor.extract(ByteImage(), features);
  EXPECT_EQ(features.size(), 0);
}

TEST(OrbPattern, TestsStayInThePatchInEveryRotation) {
  for (int r = 0; r < OrbPattern::kRotations; ++r) {
    const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(r) / OrbPattern::kRotations;
    for (const BinaryTest& t : OrbPattern::get().rotated(angle)) {
      EXPECT_LE(std::max({std::abs(t.ax), std::abs(t.ay), std::abs(t.bx), std::abs(t.by)}), kPatchRadius);
    }
  }
}

TEST(OrbPattern, NegativeAnglesAndFullTurnsAreTheSame) {
  const float turn = 2.0F * std::numbers::pi_v<float>;
  EXPECT_EQ(&OrbPattern::get().rotated(-0.5F), &OrbPattern::get().rotated(turn - 0.5F));
  EXPECT_EQ(&OrbPattern::get().rotated(0.0F), &OrbPattern::get().rotated(turn));
}

TEST(HammingDistance, CountsDifferingBits) {
  Descriptor a{}, b{};
  EXPECT_EQ(hamming_distance(a, b), 0);
  b = {~0ULL, ~0ULL, ~0ULL, ~0ULL};
  EXPECT_EQ(hamming_distance(a, b), 256);
  a[2] = 5;
  EXPECT_EQ(hamming_distance(a, Descriptor{}), 2);
}

TEST(SpreadCorners, KeepsTheStrongestOfEachRegion) {
  std::vector<Corner> corners;
  for (int i = 0; i < 500; ++i) {
    corners.push_back({static_cast<int>(100.0 * counter_uniform(1, 2 * std::uint64_t(i))),
                       static_cast<int>(50.0 * counter_uniform(1, 2 * std::uint64_t(i) + 1)), i});
  }
  const auto kept = spread_corners(corners, {0, 0, 100, 50}, 60);
  EXPECT_GE(kept.size(), 60U);
  EXPECT_LE(kept.size(), 63U);
  EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [](const Corner& c) { return c.score == 499; }));
}

TEST(SpreadCorners, TakesCoincidingCornersAndEmptyInput) {
  const std::vector<Corner> same(300, Corner{5, 5, 7});
  EXPECT_EQ(spread_corners(same, {0, 0, 10, 10}, 50).size(), 1U);
  EXPECT_TRUE(spread_corners({}, {0, 0, 10, 10}, 50).empty());
  EXPECT_TRUE(spread_corners(same, {0, 0, 10, 10}, 0).empty());
}

}  // namespace
}  // namespace penumbra::slam
