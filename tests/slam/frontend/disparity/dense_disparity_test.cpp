#include "slam/frontend/disparity/dense_disparity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "nn/base/parallel.h"
#include "nn/base/quantile.h"
#include "nn/image/resize.h"
#include "slam/world/street_sequence.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

// How far disparities are from the truth of a made pair, which is `shrink` times as large.
struct DisparityScore {
  double known = 0.0, bad = 0.0, mean = 0.0;  // shares; pixels of the pair

  DisparityScore(const FloatImage& disparity, const FloatImage& depth, double fx_b, int shrink) {
    int seen = 0, found = 0, wrong = 0;
    double sum = 0.0;
    for (int y = 0; y < disparity.height(); ++y) {
      for (int x = 0; x < disparity.width(); ++x) {
        const float z = depth.at(x * shrink + shrink / 2, y * shrink + shrink / 2);
        seen += z > 0.0F;
        if (disparity.at(x, y) <= 0.0F) continue;
        ++found;
        const double truth = z > 0.0F ? fx_b / z : 0.0;
        const double error = std::abs(disparity.at(x, y) * shrink - truth);
        wrong += error > 3.0;
        sum += std::min(error, 20.0);
      }
    }
    known = static_cast<double>(found) / seen;
    bad = static_cast<double>(wrong) / found;
    mean = sum / found;
  }
};

DisparitySettings up_to(int disparities) {
  DisparitySettings settings;
  settings.disparities = disparities;
  return settings;
}

TEST(DenseDisparity, IsNotWorseThanOpenCVsOnAStreet) {
  constexpr int kShrink = 4;
  synthetic::SequenceSettings settings;
  settings.size = {1240, 376};
  settings.seed = 7;
  synthetic::StreetSequence street(settings);
  synthetic::SequenceFrame frame;
  street.render(5, frame);
  const Size size{310, 94};
  const ByteImage left = resize_area(frame.left_grey, size), right = resize_area(frame.right_grey, size);
  const double fx_b = street.camera().fx * street.camera().baseline;

  DenseDisparity matcher(up_to(32));
  const DisparityScore ours(matcher.find(left, right), frame.left.depth, fx_b, kShrink);
  const auto reference =
      cv::StereoSGBM::create(0, 32, 3, 72, 288, 1, 0, 5, 30, 1, cv::StereoSGBM::MODE_HH);  // 8 directions
  cv::Mat sixteenths;
  reference->compute(test::to_mat(left), test::to_mat(right), sixteenths);
  FloatImage theirs(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      theirs.at(x, y) = std::max(0.0F, static_cast<float>(sixteenths.at<short>(y, x)) / 16.0F);
  }
  const DisparityScore opencv(theirs, frame.left.depth, fx_b, kShrink);
  EXPECT_GT(ours.known, 0.85);
  EXPECT_LT(ours.mean, 1.5);  // of the pair's pixels
  EXPECT_LT(ours.bad, 0.13);
  EXPECT_GT(ours.known, opencv.known);
  EXPECT_LT(ours.mean, opencv.mean);
  EXPECT_LT(ours.bad, opencv.bad);
}

TEST(DenseDisparity, FindsShiftsToAFifthOfAPixel) {
  // A texture that is finer than the images: the right one sees it `shift` further to the right.
  const auto view = [](double shift) {
    ByteImage image(120, 60);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const double u = x + shift;
        image.at(x, y) = static_cast<std::uint8_t>(std::lround(
            128.0 + 40.0 * std::sin(0.9 * u + 0.31 * y) + 30.0 * std::sin(0.53 * u - 0.7 * y + 0.02 * u * y) +
            25.0 * std::sin(0.23 * u + 1.1 * y)));
      }
    }
    return image;
  };
  DenseDisparity matcher(up_to(16));
  for (const double shift : {3.0, 5.25, 5.5, 7.75}) {
    const FloatImage& found = matcher.find(view(0.0), view(shift));
    std::vector<double> inside;
    for (int y = 5; y < 55; ++y) {
      for (int x = 20; x < 115; ++x) inside.push_back(found.at(x, y));
    }
    EXPECT_NEAR(quantile_of(inside, 0.5), shift, 0.2) << shift;
  }
}

TEST(DenseDisparity, SaysNothingOfWhatLooksTheSame) {
  DenseDisparity matcher(up_to(16));
  for (const Size& size : {Size{1, 1}, Size{3, 2}, Size{64, 32}}) {
    const ByteImage plain = ByteImage::filled(size.width, size.height, 77);
    const FloatImage& found = matcher.find(plain, plain);
    EXPECT_EQ(found.size(), size);
    EXPECT_EQ(std::count(found.data(), found.data() + found.elements(), 0.0F),
              std::ssize(std::span(found.data(), found.elements())));
  }
}

TEST(DenseDisparity, DoesNotDependOnThreads) {
  synthetic::SequenceSettings settings;
  settings.size = {310, 94};
  synthetic::StreetSequence street(settings);
  synthetic::SequenceFrame frame;
  street.render(0, frame);
  DenseDisparity matcher({});
  const FloatImage many = matcher.find(frame.left_grey, frame.right_grey).clone();
  const ThreadCountScope alone(1);
  const FloatImage& one = matcher.find(frame.left_grey, frame.right_grey);
  EXPECT_TRUE(std::equal(one.data(), one.data() + one.elements(), many.data()));
}

}  // namespace
}  // namespace penumbra::slam
