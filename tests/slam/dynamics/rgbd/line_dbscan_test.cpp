#include "slam/dynamics/rgbd/line_dbscan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

// The algorithm as it was published, over all pairs, in ascending order of the numbers.
std::vector<int> naive_dbscan(const std::vector<float>& x, float eps, int fewest) {
  const auto near = [&](std::size_t i) {
    std::vector<std::size_t> found;
    for (std::size_t j = 0; j < x.size(); ++j) {
      if ((x[j] >= x[i] ? x[j] - x[i] : x[i] - x[j]) <= eps) found.push_back(j);
    }
    return found;
  };
  std::vector<int> cluster(x.size(), kNoise);
  std::vector<char> visited(x.size(), 0);
  int clusters = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (visited[i]) continue;
    visited[i] = 1;
    const std::vector<std::size_t> first = near(i);
    if (first.size() < static_cast<std::size_t>(fewest)) continue;
    cluster[i] = clusters;
    std::deque<std::size_t> queue(first.begin(), first.end());
    for (; !queue.empty(); queue.pop_front()) {
      const std::size_t j = queue.front();
      if (cluster[j] == kNoise) cluster[j] = clusters;
      if (visited[j]) continue;
      visited[j] = 1;
      const std::vector<std::size_t> more = near(j);
      if (more.size() >= static_cast<std::size_t>(fewest))
        queue.insert(queue.end(), more.begin(), more.end());
    }
    ++clusters;
  }
  return cluster;
}

TEST(LineDbscan, FindsTheClustersOfTheAlgorithmOverAllPairs) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const int n = static_cast<int>(counter_random(seed, 0) % 60);
    std::vector<float> x;
    // On a grid, as quantised depths are: many are equal, many exactly eps apart.
    for (int i = 0; i < n; ++i)
      x.push_back(0.25F * static_cast<float>(counter_random(seed, 10 + static_cast<std::uint64_t>(i)) % 80));
    std::sort(x.begin(), x.end());
    const float eps = 0.25F * static_cast<float>(counter_random(seed, 1) % 6);
    const int fewest = 1 + static_cast<int>(counter_random(seed, 2) % 7);
    std::vector<int> cluster;
    const int clusters = line_dbscan(x, eps, fewest, cluster);
    EXPECT_EQ(cluster, naive_dbscan(x, eps, fewest)) << "seed " << seed;
    EXPECT_EQ(clusters, cluster.empty() ? 0 : 1 + *std::max_element(cluster.begin(), cluster.end()));
  }
}

// The example of docs/dynamics/static-points.md.
TEST(LineDbscan, FollowsTheExampleOfTheDocuments) {
  const std::vector<float> x = {1.0F, 1.1F, 1.2F, 1.3F, 2.0F, 3.0F, 3.1F, 3.2F};
  std::vector<int> cluster;
  EXPECT_EQ(line_dbscan(x, 0.15F, 3, cluster), 2);
  EXPECT_EQ(cluster, (std::vector<int>{0, 0, 0, 0, kNoise, 1, 1, 1}));
}

TEST(LineDbscan, TakesNothingAndOne) {
  std::vector<int> cluster = {7};
  EXPECT_EQ(line_dbscan({}, 1.0F, 1, cluster), 0);
  EXPECT_TRUE(cluster.empty());
  const std::vector<float> one = {2.0F};
  EXPECT_EQ(line_dbscan(one, 0.0F, 1, cluster), 1);
  EXPECT_EQ(line_dbscan(one, 0.0F, 2, cluster), 0);
  EXPECT_EQ(cluster[0], kNoise);
}

TEST(LineDbscan, DistancesToTheNearestAreThoseOfAllPairs) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::vector<float> x;
    const int n = 2 + static_cast<int>(counter_random(seed, 0) % 40);
    for (int i = 0; i < n; ++i)
      x.push_back(static_cast<float>(counter_random(seed, 10 + static_cast<std::uint64_t>(i)) % 50));
    std::sort(x.begin(), x.end());
    const int k = 1 + static_cast<int>(counter_random(seed, 1) % static_cast<std::uint64_t>(n - 1));
    std::vector<float> distance;
    nearest_distances(x, k, distance);
    for (std::size_t i = 0; i < x.size(); ++i) {
      std::vector<float> all;
      for (std::size_t j = 0; j < x.size(); ++j) {
        if (j != i) all.push_back(std::abs(x[j] - x[i]));
      }
      std::sort(all.begin(), all.end());
      EXPECT_EQ(distance[i], all[static_cast<std::size_t>(k - 1)]) << "seed " << seed << " number " << i;
    }
  }
}

TEST(LineDbscan, TheKneeIsWhereTheCurveTurnsUp) {
  std::vector<float> curve;
  for (int i = 0; i < 90; ++i) curve.push_back(0.01F * static_cast<float>(i));
  for (int i = 0; i < 10; ++i) curve.push_back(0.9F + static_cast<float>(i));
  EXPECT_NEAR(knee_of(curve), 0.9F, 0.011F);
  EXPECT_EQ(knee_of({}), 0.0F);
  const std::vector<float> flat(5, 2.0F);
  EXPECT_EQ(knee_of(flat), 2.0F);
}

}  // namespace
}  // namespace penumbra::slam
