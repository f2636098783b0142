#include "slam/dynamics/rgbd/depth_kmeans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

// Lloyd over the depths themselves, from the same start.
std::vector<double> centres_over_pixels(std::vector<double> depths, int k) {
  std::sort(depths.begin(), depths.end());
  std::vector<double> centres;
  for (int j = 0; j < k; ++j)
    centres.push_back(depths[static_cast<std::size_t>((j + 0.5) / k * static_cast<double>(depths.size()))]);
  for (int iteration = 0; iteration < 50; ++iteration) {
    std::vector<double> sums(centres.size()), counts(centres.size());
    for (const double z : depths) {
      std::size_t best = 0;
      for (std::size_t j = 1; j < centres.size(); ++j) {
        if (std::abs(z - centres[j]) < std::abs(z - centres[best])) best = j;
      }
      sums[best] += z;
      ++counts[best];
    }
    for (std::size_t j = 0; j < centres.size(); ++j) {
      if (counts[j] > 0) centres[j] = sums[j] / counts[j];
    }
  }
  return centres;
}

TEST(DepthKmeans, EqualsClustersOverPixels) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<double> depths;
    DepthHistogram histogram;
    for (std::uint64_t n = 0; n < 4000; ++n) {
      const double surface = n % 3 == 0 ? 1.2 : n % 3 == 1 ? 2.1 : 3.4;
      depths.push_back(surface + 0.2 * (counter_uniform(seed, n) - 0.5));
      histogram.add(static_cast<float>(depths.back()));
    }
    for (const int k : {2, 3, 8}) {
      const std::vector<double> expected = centres_over_pixels(depths, k);
      DepthKmeans kmeans;
      const std::vector<DepthCluster>& found = kmeans.cluster(histogram, k);
      ASSERT_EQ(found.size(), expected.size());
      int count = 0;
      for (std::size_t j = 0; j < found.size(); ++j) {
        EXPECT_NEAR(found[j].mean, expected[j], 0.015 * expected[j]) << "k " << k << " cluster " << j;
        EXPECT_LE(found[j].first, found[j].last);
        EXPECT_GT(found[j].first, j == 0 ? -1 : found[j - 1].last);
        count += found[j].count;
      }
      EXPECT_EQ(count, 4000);
    }
  }
}

TEST(DepthKmeans, TakesWhatThereIs) {
  DepthHistogram histogram;
  DepthKmeans kmeans;
  EXPECT_TRUE(kmeans.cluster(histogram, 8).empty());
  histogram.add(2.0F);
  ASSERT_EQ(kmeans.cluster(histogram, 8).size(), 1U);
  EXPECT_EQ(kmeans.cluster(histogram, 8).front().mean, 2.0);
  EXPECT_TRUE(kmeans.cluster(histogram, 0).empty());
  histogram.add(0.01F);  // nearer than the nearest bin
  histogram.add(1e6F);
  EXPECT_EQ(kmeans.cluster(histogram, 8).size(), 3U);
  histogram.clear();
  EXPECT_TRUE(kmeans.cluster(histogram, 8).empty());
}

}  // namespace
}  // namespace penumbra::slam
