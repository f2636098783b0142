#include "slam/evaluation/matching_evaluation.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "apps/sift/sift_baseline.h"
#include "nn/base/error.h"
#include "slam/evaluation/matching_plot.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

const StereoCamera kCamera{300.0, 300.0, 160.0, 120.0, 0.5, 320, 240};

// A wall of blotches, seen from `x` metres to the right, 2 m away: it moves by 150 pixels a metre.
StereoImages wall(double x) {
  cv::Mat big(400, 800, CV_8UC1);
  cv::RNG rng(7);
  rng.fill(big, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(big, big, {0, 0}, 2.0);
  cv::normalize(big, big, 0, 255, cv::NORM_MINMAX);
  // From the right, half a metre on, it is 75 pixels further to the left.
  const cv::Rect window(100 + cvRound(x * 150.0), 80, 320, 240);
  return {0, x, test::byte_image(big(window)), test::byte_image(big(window + cv::Point(75, 0))), {}};
}

SE3 at(double x) { return {Eigen::Matrix3d::Identity(), {x, 0.0, 0.0}}; }

TEST(MotionCheck, MeasuresTheDistanceFromTheEpipolarLine) {
  const SE3 T_21 = at(0.2).inverse();  // sideways: epipolar lines are rows
  const MotionCheck check(kCamera, T_21);
  EXPECT_NEAR(check.distance({100, 50}, {70, 50}), 0.0, 1e-9);
  EXPECT_NEAR(check.distance({100, 50}, {10, 50}), 0.0, 1e-9);
  EXPECT_NEAR(check.distance({100, 50}, {70, 53}), 3.0, 1e-9);
}

TEST(MotionCheck, ComparesTurnedPixelsWhereTheCameraStoodStill) {
  const SE3 turn{so3_exp({0.0, 0.1, 0.0}), Eigen::Vector3d::Zero()};
  const MotionCheck check(kCamera, turn);
  const Eigen::Vector3d p(0.2, 0.1, 2.0);
  const Eigen::Vector2d first = kCamera.project(p), second = kCamera.project(turn * p);
  EXPECT_NEAR(check.distance(first, second), 0.0, 1e-9);
  EXPECT_NEAR(check.distance(first, second + Eigen::Vector2d(3.0, 4.0)), 5.0, 1e-9);
}

TEST(MatchingEvaluation, CountsPairsThatAgreeWithTheTruth) {
  MatchingSettings settings;
  settings.orb_features = 300;
  settings.baseline = [] { return std::make_unique<apps::SiftBaseline>(); };
  MatchingEvaluation good(kCamera, settings), bad(kCamera, settings);
  for (int i = 0; i < 3; ++i) {
    const StereoImages images = wall(0.2 * i);
    good.add(images, at(0.2 * i));
    // The path says forwards: few pairs lie on those epipolar lines.
    bad.add(images, {Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.2 * i}});
  }
  for (const MatchingMethod method : kMatchingMethods) {
    SCOPED_TRACE(name_of(method));
    const MatchingCounts& counts = good.counts(method);
    EXPECT_EQ(counts.images, 2);
    EXPECT_GT(counts.pairs, 100);
    EXPECT_GT(counts.rate(), 85.0);
    EXPECT_LT(bad.counts(method).rate(), 60.0);
    // Only the compensated filter knows where the camera was.
    if (method != MatchingMethod::orb_compensated) {
      EXPECT_EQ(bad.counts(method).pairs, counts.pairs);
    }
    EXPECT_GT(counts.match_ms, 0.0);
  }
  EXPECT_LE(good.counts(MatchingMethod::orb_paper).pairs, good.counts(MatchingMethod::orb).pairs);
  EXPECT_EQ(good.counts(MatchingMethod::orb).filter_ms, 0.0);
  // The motion of the first pair predicts that of the second, and the wall's depth is known.
  EXPECT_GT(good.counts(MatchingMethod::orb_compensated).rate(), 97.0);

  const DisplacementHistogram& histogram = good.histogram(MatchingMethod::orb_paper);
  int kept = 0, all = 0;
  for (const auto& bin : histogram.bins) {
    kept += bin.effective_kept + bin.wrong_kept;
    all += bin.effective_kept + bin.wrong_kept + bin.effective_removed + bin.wrong_removed;
  }
  EXPECT_EQ(kept, good.counts(MatchingMethod::orb_paper).pairs);
  EXPECT_EQ(all, good.counts(MatchingMethod::orb).pairs);
  const auto most =
      std::max_element(histogram.bins.begin(), histogram.bins.end(),
                       [](const auto& a, const auto& b) { return a.effective_kept < b.effective_kept; });
  EXPECT_NEAR(static_cast<double>(most - histogram.bins.begin()) * DisplacementHistogram::kWidth, 30.0, 2.0);
}

TEST(MatchingEvaluation, ImagesWithoutFeaturesHaveNoPairs) {
  MatchingEvaluation evaluation(kCamera, {});
  for (int i = 0; i < 2; ++i) {
    StereoImages images;
    images.left = ByteImage::filled(320, 240, 128);
    evaluation.add(images, at(0.1 * i));
  }
  for (const MatchingMethod method : kMatchingMethods) {
    EXPECT_EQ(evaluation.counts(method).pairs, 0);
    EXPECT_EQ(evaluation.counts(method).rate(), 0.0);
  }
}

TEST(MatchingPlot, ShowsEveryPanelInItsColours) {
  DisplacementHistogram histogram;
  histogram.bins[5] = {900, 100, 50, 400};
  const cv::Mat one = test::to_mat(draw_displacements("title", {{"first", histogram}}).picture());
  const cv::Mat two =
      test::to_mat(draw_displacements("title", {{"first", histogram}, {"second", {}}}).picture());
  EXPECT_EQ(one.cols, two.cols);
  EXPECT_GT(two.rows, one.rows);
  for (const cv::Scalar& colour : {cv::Scalar(178, 114, 0), cv::Scalar(0, 94, 213)}) {
    cv::Mat found;
    cv::inRange(one, colour, colour, found);
    EXPECT_GT(cv::countNonZero(found), 500);
  }
  EXPECT_THROW(draw_displacements("title", {}), Error);
}

}  // namespace
}  // namespace penumbra::slam
