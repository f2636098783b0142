// What the mismatch filter does to real matches (slam/evaluation/matching_evaluation.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "slam/evaluation/matching_evaluation.h"
#include "slam/sources/open_dataset.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

void expect_adaptive_filter_helps(const std::filesystem::path& folder) {
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  MatchingSettings settings;
  MatchingEvaluation evaluation(dataset->camera(), settings);
  for (int i = 0; i < std::min(dataset->size(), 50); ++i) {
    evaluation.add(dataset->load(i), (*dataset->ground_truth())[std::size_t(i)].T_wc);
  }
  for (const MatchingMethod method : kMatchingMethods) {
    const MatchingCounts& c = evaluation.counts(method);
    std::printf("%-22s  pairs %6d  effective %6d  rate %.1f %%\n", name_of(method), c.pairs, c.effective,
                c.rate());
  }
  const MatchingCounts &off = evaluation.counts(MatchingMethod::orb),
                       &paper = evaluation.counts(MatchingMethod::orb_paper),
                       &adaptive = evaluation.counts(MatchingMethod::orb_adaptive);
  EXPECT_GE(adaptive.rate(), off.rate() + 5.0);
  EXPECT_GE(adaptive.effective, 0.9 * off.effective);
  EXPECT_GT(adaptive.effective, paper.effective);
}

TEST(MismatchFilterRealData, RaisesTheEffectiveRateOfKitti00) {
  PENUMBRA_REAL_DATA(folder, "kitti/sequences/00");
  expect_adaptive_filter_helps(folder);
}

TEST(MismatchFilterRealData, RaisesTheEffectiveRateOfKitti06) {
  PENUMBRA_REAL_DATA(folder, "kitti/sequences/06");
  expect_adaptive_filter_helps(folder);
}

}  // namespace
}  // namespace penumbra::slam
