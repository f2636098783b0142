// What the mismatch filter does to real matches: descriptors compared without any prediction (nearest
// neighbour), consecutive left images; a pair is effective if its symmetric epipolar distance under the true
// motion is below 2 pixels.
#include <gtest/gtest.h>

#include <cstdio>

#include "slam/datasets/open_dataset.h"
#include "slam/features/descriptor_matcher.h"
#include "slam/features/mismatch_filter.h"
#include "slam/features/orb_extractor.h"
#include "slam/geometry/triangulation.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

constexpr double kEffective = 2.0;  // pixels

struct Counts {
  int pairs = 0, effective = 0;
  double rate() const { return 100.0 * effective / std::max(pairs, 1); }
};

// Counts of the pairs that each mode keeps, in the order off, paper, adaptive.
std::array<Counts, 3> measure(const std::filesystem::path& folder) {
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  OrbSettings orb;
  orb.features = 1000;
  OrbExtractor extractor(orb);
  DescriptorMatcherSettings matching;
  matching.max_distance = kDescriptorBits;
  matching.ratio = 1.0F;  // plain matching: the filter is to do the work
  std::array<Counts, 3> counts;
  Features before, now;
  for (int i = 0; i < dataset->size(); i += 1) {
    extractor.extract(dataset->load(i).left, now);
    if (i > 0 && i % 3 == 0) {
      const SE3 T_aw = (*dataset->ground_truth())[std::size_t(i - 1)].T_wc.inverse();
      const SE3 T_bw = (*dataset->ground_truth())[std::size_t(i)].T_wc.inverse();
      const Eigen::Matrix3d F = fundamental_matrix(dataset->camera(), T_aw, T_bw);
      std::vector<MatchedPixels> pairs;
      std::vector<char> effective, keep;
      for (const Match& m : match_descriptors(before.descriptors, now.descriptors, matching)) {
        const Keypoint &a = before.keypoints[std::size_t(m.source)],
                       &b = now.keypoints[std::size_t(m.feature)];
        pairs.push_back({{a.u, a.v}, {b.u, b.v}});
        const Eigen::Vector2d pa(a.u, a.v), pb(b.u, b.v);
        const double distance =
            std::max(squared_epipolar_distance(F, pa, pb), squared_epipolar_distance(F.transpose(), pb, pa));
        effective.push_back(distance < kEffective * kEffective);
      }
      constexpr std::array kModes = {MismatchFilterMode::off, MismatchFilterMode::paper,
                                     MismatchFilterMode::adaptive};
      for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
        MismatchFilterSettings settings;
        settings.mode = kModes[mode];
        filter_mismatches(pairs, settings, keep);
        for (std::size_t k = 0; k < keep.size(); ++k) {
          counts[mode].pairs += keep[k];
          counts[mode].effective += keep[k] && effective[k];
        }
      }
    }
    std::swap(before, now);
  }
  return counts;
}

void expect_adaptive_filter_helps(const std::filesystem::path& folder) {
  const std::array<Counts, 3> counts = measure(folder);
  constexpr std::array kNames = {"off", "paper", "adaptive"};
  for (std::size_t mode = 0; mode < 3; ++mode) {
    std::printf("%-8s  pairs %6d  effective %6d  rate %.1f %%\n", kNames[mode], counts[mode].pairs,
                counts[mode].effective, counts[mode].rate());
  }
  const auto& [off, paper, adaptive] = counts;
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
