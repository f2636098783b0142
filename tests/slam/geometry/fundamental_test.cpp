#include "slam/geometry/fundamental.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

struct Views {
  std::vector<PointPair> pairs;
  Eigen::Matrix3d F;
  int good = 0;  // the first ones
};

// Points in a room, seen by a camera that turns and moves; `wrong` more whose partners are anywhere.
Views make_views(int good, int wrong, double noise, std::uint64_t seed) {
  Views views;
  views.good = good;
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.3, 1.0, 0.2).normalized()).toRotationMatrix();
  const Eigen::Vector3d t(0.12, -0.03, 0.06);
  Eigen::Matrix3d K;
  K << 525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0;
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  views.F = K.inverse().transpose() * cross * R * K.inverse();
  views.F.normalize();
  std::uint64_t counter = 0;
  const auto random = [&](double low, double high) {
    return low + (high - low) * counter_uniform(seed, counter++);
  };
  for (int i = 0; i < good + wrong; ++i) {
    const Eigen::Vector3d X(random(-1.5, 1.5), random(-1.0, 1.0), random(1.5, 5.0));
    PointPair pair{(K * X).hnormalized(), (K * (R * X + t)).hnormalized()};
    if (i >= good) pair.second = {random(0.0, 640.0), random(0.0, 480.0)};
    for (Eigen::Vector2d* p : {&pair.first, &pair.second})
      *p += Eigen::Vector2d(random(-noise, noise), random(-noise, noise));
    views.pairs.push_back(pair);
  }
  return views;
}

double largest_distance(const Views& views, const Eigen::Matrix3d& F) {
  double most = 0.0;
  for (int i = 0; i < views.good; ++i)
    most = std::max(most, sampson_distance(F, views.pairs[static_cast<std::size_t>(i)]));
  return most;
}

TEST(Fundamental, EightExactPairsGiveTheTrueMatrix) {
  for (const int n : {8, 20, 100}) {
    const Views views = make_views(n, 0, 0.0, 3);
    const auto F = solve_fundamental(views.pairs);
    ASSERT_TRUE(F);
    const double sign = F->cwiseProduct(views.F).sum() < 0.0 ? -1.0 : 1.0;
    EXPECT_LT((sign * *F - views.F).norm(), n == 8 ? 1e-5 : 1e-7);
    EXPECT_LT(std::abs(F->determinant()), 1e-12);
  }
}

TEST(Fundamental, FindsTheInliersAsOpenCvDoes) {
  for (const int wrong : {0, 50, 100}) {
    const Views views = make_views(200, wrong, 0.2, 7);
    const auto found = find_fundamental(views.pairs);
    ASSERT_TRUE(found);
    std::vector<cv::Point2d> first, second;
    for (const PointPair& pair : views.pairs) {
      first.emplace_back(pair.first.x(), pair.first.y());
      second.emplace_back(pair.second.x(), pair.second.y());
    }
    std::vector<uchar> mask;
    const cv::Mat F_cv = cv::findFundamentalMat(first, second, cv::FM_RANSAC, 1.0, 0.99, mask);
    Eigen::Matrix3d F_theirs;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) F_theirs(r, c) = F_cv.at<double>(r, c);
    }
    int agree = 0;
    for (std::size_t i = 0; i < views.pairs.size(); ++i) agree += (found->inlier[i] != 0) == (mask[i] != 0);
    // Theirs are the inliers of the best draw, ours of the matrix that all of those give.
    EXPECT_GE(agree, 0.9 * static_cast<double>(views.pairs.size()));
    EXPECT_LT(largest_distance(views, found->F), 1.0);
    EXPECT_LE(largest_distance(views, found->F), 1.5 * largest_distance(views, F_theirs) + 0.1);
    int good = 0, bad = 0;
    for (std::size_t i = 0; i < views.pairs.size(); ++i)
      (static_cast<int>(i) < views.good ? good : bad) += found->inlier[i] != 0;
    EXPECT_EQ(good, 200);
    EXPECT_LE(bad, 6);  // by chance a wrong partner lies on the line
  }
}

TEST(Fundamental, Repeats) {
  const Views views = make_views(60, 40, 0.3, 11);
  const auto a = find_fundamental(views.pairs), b = find_fundamental(views.pairs);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->F, b->F);
  EXPECT_EQ(a->inlier, b->inlier);
}

TEST(Fundamental, SaysNothingWithoutEnough) {
  EXPECT_FALSE(find_fundamental({}));
  EXPECT_FALSE(find_fundamental(make_views(7, 0, 0.0, 1).pairs));
  std::vector<PointPair> same(20, {{100.0, 100.0}, {101.0, 100.0}});
  EXPECT_FALSE(find_fundamental(same));
}

TEST(Fundamental, StandingImagesFitEveryPoint) {
  Views views = make_views(50, 0, 0.0, 5);
  for (PointPair& pair : views.pairs) pair.second = pair.first;
  const auto found = find_fundamental(views.pairs);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 50);
}

TEST(Fundamental, TheEpipolarDistanceIsThatToTheLine) {
  Eigen::Matrix3d F;  // camera that moves along x: lines are rows
  F << 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0;
  EXPECT_NEAR(epipolar_distance(F, {{10.0, 20.0}, {300.0, 20.0}}), 0.0, 1e-12);
  EXPECT_NEAR(epipolar_distance(F, {{10.0, 20.0}, {300.0, 23.5}}), 3.5, 1e-12);
}

}  // namespace
}  // namespace penumbra::slam
