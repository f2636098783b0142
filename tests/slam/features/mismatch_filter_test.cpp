#include "slam/features/mismatch_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "nn/base/error.h"

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
    for (const auto m : {MismatchFilterMode::off, MismatchFilterMode::paper, MismatchFilterMode::adaptive}) {
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
  for (const auto m : {MismatchFilterMode::paper, MismatchFilterMode::adaptive}) {
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

TEST(MismatchFilter, NamesAreReadAndWritten) {
  EXPECT_EQ(mismatch_filter_mode("paper"), MismatchFilterMode::paper);
  EXPECT_EQ(name_of(MismatchFilterMode::adaptive), "adaptive");
  EXPECT_THROW(mismatch_filter_mode("histogram"), UsageError);
}

}  // namespace
}  // namespace penumbra::slam
