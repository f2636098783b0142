#include "slam/frontend/features/mismatch_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "nn/base/error.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {
namespace {

std::vector<MatchedPixels> pairs_with(const std::vector<double>& distances) {
  std::vector<MatchedPixels> pairs;
  for (const double d : distances) {
    pairs.push_back(
        {{10.0F, 20.0F}, {10.0F + static_cast<float>(0.6 * d), 20.0F + static_cast<float>(0.8 * d)}});
  }
  return pairs;
}

constexpr MismatchFilterMode kModes[] = {MismatchFilterMode::off, MismatchFilterMode::paper,
                                         MismatchFilterMode::adaptive, MismatchFilterMode::compensated};

MismatchFilterSettings mode(MismatchFilterMode m) {
  MismatchFilterSettings settings;
  settings.mode = m;
  return settings;
}

TEST(MismatchFilter, OffKeepsEverything) {
  std::vector<char> keep;
  const MismatchFilterReport report =
      filter_mismatches(pairs_with({1, 2, 3, 100, 5}), mode(MismatchFilterMode::off), keep);
  EXPECT_EQ(keep, std::vector<char>(5, 1));
  EXPECT_EQ(report.kept, 5);
  EXPECT_EQ(report.removed, 0);
}

TEST(MismatchFilter, PaperFollowsEquations10To12OnAnExampleWorkedByHand) {
  // N = 9: gamma = 3, L = (12 - 0) / 3 = 4, bins [0, 4) [4, 8) [8, 12) [12, 16] hold 5, 2, 1, 1 pairs.
  std::vector<char> keep;
  const MismatchFilterReport report =
      filter_mismatches(pairs_with({0, 1, 2, 3, 3.5, 5, 7, 9, 12}), mode(MismatchFilterMode::paper), keep);
  EXPECT_EQ(keep, (std::vector<char>{1, 1, 1, 1, 1, 0, 0, 0, 0}));
  ASSERT_EQ(report.bins.size(), 4U);
  EXPECT_NEAR(report.bins[1].from, 4.0, 1e-5);
  EXPECT_NEAR(report.bins[1].to, 8.0, 1e-5);
  EXPECT_EQ(report.bins[0].kept, 5);
  EXPECT_EQ(report.bins[1].removed, 2);
  EXPECT_EQ(report.bins[2].removed, 1);
  EXPECT_EQ(report.bins[3].removed, 1);
  EXPECT_EQ(report.kept, 5);
  EXPECT_EQ(report.removed, 4);
}

TEST(MismatchFilter, PaperKeepsTheBinsThatTieForTheMost) {
  // N = 4: gamma = 2, L = 4, bins [0, 4) [4, 8) [8, 12] hold 2, 0, 2.
  std::vector<char> keep;
  filter_mismatches(pairs_with({0, 1, 8, 8}), mode(MismatchFilterMode::paper), keep);
  EXPECT_EQ(keep, std::vector<char>(4, 1));
}

TEST(MismatchFilter, PaperCollapsesOnCleanMatchesWhereAdaptiveDoesNot) {
  // A camera that drives forward: distances from 2 to 60 pixels, the small ones more often, none of them
  // wrong.
  std::vector<double> distances;
  for (int i = 0; i < 400; ++i) distances.push_back(2.0 + 58.0 * std::pow(i / 399.0, 1.5));
  std::vector<char> keep;
  EXPECT_LT(filter_mismatches(pairs_with(distances), mode(MismatchFilterMode::paper), keep).kept, 60);
  EXPECT_EQ(filter_mismatches(pairs_with(distances), mode(MismatchFilterMode::adaptive), keep).kept, 400);
}

TEST(MismatchFilter, AdaptiveRemovesGrossMismatchesAndKeepsTheRest) {
  std::mt19937 random(1);
  std::exponential_distribution<double> good(1.0 / 15.0);
  std::uniform_real_distribution<double> wrong(200.0, 1000.0);
  std::vector<double> distances;
  for (int i = 0; i < 400; ++i) distances.push_back(good(random));
  for (int i = 0; i < 80; ++i) distances.push_back(wrong(random));
  std::vector<char> keep;
  filter_mismatches(pairs_with(distances), mode(MismatchFilterMode::adaptive), keep);
  int good_kept = 0, wrong_kept = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) (i < 400 ? good_kept : wrong_kept) += keep[i];
  EXPECT_GT(good_kept, 370);
  EXPECT_EQ(wrong_kept, 0);
}

TEST(MismatchFilter, EveryPairIsCountedOnce) {
  std::mt19937 random(2);
  std::gamma_distribution<double> distance(2.0, 20.0);
  for (const int n : {0, 1, 2, 7, 8, 50, 333}) {
    std::vector<double> distances;
    for (int i = 0; i < n; ++i) distances.push_back(distance(random));
    for (const auto m : kModes) {
      std::vector<char> keep;
      const MismatchFilterReport report = filter_mismatches(pairs_with(distances), mode(m), keep);
      ASSERT_EQ(keep.size(), static_cast<std::size_t>(n));
      int kept = 0, in_bins_kept = 0, in_bins_removed = 0;
      for (const char k : keep) kept += k;
      for (const auto& bin : report.bins) {
        in_bins_kept += bin.kept;
        in_bins_removed += bin.removed;
      }
      EXPECT_EQ(kept, report.kept);
      EXPECT_EQ(report.kept + report.removed, n);
      EXPECT_EQ(in_bins_removed + report.outside, report.removed);
      EXPECT_EQ(in_bins_kept, report.kept);
    }
  }
}

TEST(MismatchFilter, TakesEqualDistancesAndNumbersThatAreNone) {
  for (const auto m :
       {MismatchFilterMode::paper, MismatchFilterMode::adaptive, MismatchFilterMode::compensated}) {
    std::vector<char> keep;
    EXPECT_EQ(filter_mismatches(pairs_with(std::vector<double>(20, 5.0)), mode(m), keep).kept, 20);
    std::vector<MatchedPixels> pairs = pairs_with(std::vector<double>(20, 5.0));
    pairs[3].first.x() = std::numeric_limits<float>::quiet_NaN();
    pairs[4].second.y() = std::numeric_limits<float>::infinity();
    const MismatchFilterReport report = filter_mismatches(pairs, mode(m), keep);
    EXPECT_EQ(report.kept, 18);
    EXPECT_FALSE(keep[3]);
    EXPECT_FALSE(keep[4]);
  }
}

// Behind a lorry: 320 features of it, 12 m ahead and slowly coming nearer, and 100 of the street on both
// sides, 5 to 15 m away. The camera drives 0.8 m forwards, as predicted; matches are half a pixel off.
struct BehindALorry {
  std::vector<MatchedPixels> pairs;
  static constexpr std::size_t kLorry = 320, kStreet = 100;

  BehindALorry() {
    std::mt19937 random(3);
    std::normal_distribution<float> noise(0.0F, 0.5F);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const StereoCamera camera{700.0, 700.0, 600.0, 180.0, 0.5, 1200, 360};
    const Eigen::Vector3d step(0.0, 0.0, -0.8);
    for (std::size_t i = 0; i < kLorry + kStreet; ++i) {
      const bool lorry = i < kLorry;
      const Eigen::Vector3d point =
          lorry ? Eigen::Vector3d(2.5 * (unit(random) - 0.5), 3.0 * (unit(random) - 0.5), 12.0)
                : Eigen::Vector3d(unit(random) < 0.5 ? -4.0 : 4.0, 2.0 * (unit(random) - 0.5),
                                  5.0 + 10.0 * unit(random));
      const Eigen::Vector3d later = point + (lorry ? Eigen::Vector3d(0.0, 0.0, -0.05) : step);
      const Eigen::Vector2f off(noise(random), noise(random));
      pairs.push_back({camera.project(point).cast<float>(), camera.project(later).cast<float>() + off,
                       camera.project(point + step).cast<float>()});
    }
  }
  static int of_street(const std::vector<char>& keep) {
    return static_cast<int>(std::count(keep.begin() + kLorry, keep.end(), 1));
  }
};

TEST(MismatchFilter, CompensatedKeepsTheStreetBehindALorryThatWinsThePlainVote) {
  const BehindALorry scene;
  std::vector<char> keep;
  filter_mismatches(scene.pairs, mode(MismatchFilterMode::paper), keep);
  EXPECT_LT(BehindALorry::of_street(keep), 15);
  filter_mismatches(scene.pairs, mode(MismatchFilterMode::adaptive), keep);
  EXPECT_LT(BehindALorry::of_street(keep), 35);
  filter_mismatches(scene.pairs, mode(MismatchFilterMode::compensated), keep);
  EXPECT_EQ(BehindALorry::of_street(keep), 100);
}

TEST(MismatchFilter, CompensatedRemovesWhatIsNotWhereItWasExpected) {
  BehindALorry scene;
  scene.pairs.erase(scene.pairs.begin() + 20, scene.pairs.begin() + BehindALorry::kLorry);
  for (std::size_t i = 0; i < 20; ++i)
    scene.pairs[i].second = *scene.pairs[i].expected + Eigen::Vector2f(9.0F, 0.0F);
  std::vector<char> keep;
  const MismatchFilterReport report =
      filter_mismatches(scene.pairs, mode(MismatchFilterMode::compensated), keep);
  EXPECT_EQ(std::count(keep.begin(), keep.begin() + 20, 1), 0);
  EXPECT_GE(report.kept, 95);
  EXPECT_EQ(report.bins.front().from, 0.0);
}

TEST(MismatchFilter, CompensatedIsAdaptiveWhereNothingIsExpected) {
  std::vector<MatchedPixels> pairs = BehindALorry().pairs;
  for (MatchedPixels& pair : pairs) pair.expected.reset();
  std::vector<char> adaptive, compensated;
  const MismatchFilterReport a = filter_mismatches(pairs, mode(MismatchFilterMode::adaptive), adaptive),
                             c = filter_mismatches(pairs, mode(MismatchFilterMode::compensated), compensated);
  EXPECT_EQ(adaptive, compensated);
  ASSERT_EQ(a.bins.size(), c.bins.size());
  EXPECT_EQ(a.bins[1].from, c.bins[1].from);
}

TEST(MismatchFilter, CompensatedJudgesPairsWithoutDepthByTheDistancesOfAll) {
  std::vector<MatchedPixels> pairs = BehindALorry().pairs;
  std::vector<char> adaptive, all, some;
  filter_mismatches(pairs, mode(MismatchFilterMode::adaptive), adaptive);
  filter_mismatches(pairs, mode(MismatchFilterMode::compensated), all);
  for (std::size_t i = BehindALorry::kLorry; i < pairs.size(); i += 2) pairs[i].expected.reset();
  pairs[1].expected->x() = std::numeric_limits<float>::quiet_NaN();
  pairs[3].first.x() = std::numeric_limits<float>::quiet_NaN();
  pairs[5].second.x() = std::numeric_limits<float>::infinity();
  const MismatchFilterReport report = filter_mismatches(pairs, mode(MismatchFilterMode::compensated), some);
  for (std::size_t i = BehindALorry::kLorry; i < pairs.size(); ++i) {
    EXPECT_EQ(some[i], (i % 2 == 0 ? adaptive : all)[i]) << i;
  }
  EXPECT_EQ(some[1], adaptive[1]);
  EXPECT_FALSE(some[3]);
  EXPECT_FALSE(some[5]);
  EXPECT_EQ(report.kept, std::count(some.begin(), some.end(), 1));
  EXPECT_EQ(report.kept + report.removed, static_cast<int>(pairs.size()));
}

TEST(MismatchFilter, CompensatedKeepsFewPairsAndThoseThatAreExactlyWhereTheyWereExpected) {
  std::vector<MatchedPixels> pairs = pairs_with({1, 2, 3, 100, 5, 6, 7});
  for (MatchedPixels& pair : pairs) pair.expected = pair.first;
  std::vector<char> keep;
  EXPECT_EQ(filter_mismatches(pairs, mode(MismatchFilterMode::compensated), keep).kept, 7);
  pairs = pairs_with(std::vector<double>(20, 5.0));
  for (MatchedPixels& pair : pairs) pair.expected = pair.second;
  EXPECT_EQ(filter_mismatches(pairs, mode(MismatchFilterMode::compensated), keep).kept, 20);
  EXPECT_EQ(filter_mismatches({}, mode(MismatchFilterMode::compensated), keep).kept, 0);
  EXPECT_TRUE(keep.empty());
}

TEST(MismatchFilter, NamesAreReadAndWritten) {
  for (const auto m : kModes) EXPECT_EQ(mismatch_filter_mode(name_of(m)), m);
  EXPECT_EQ(name_of(MismatchFilterMode::compensated), "compensated");
  EXPECT_THROW(mismatch_filter_mode("histogram"), UsageError);
}

}  // namespace
}  // namespace penumbra::slam
