#include "slam/brain/position/autocorrelogram.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/slam/brain/position/made_maps.h"

namespace penumbra::slam::brain {
namespace {

float naive_correlation(const RateMap& map, int dx, int dy) {
  double n = 0, a = 0, b = 0, ab = 0, aa = 0, bb = 0;
  for (int y = 0; y < map.size; ++y) {
    for (int x = 0; x < map.size; ++x) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= map.size || v >= map.size) continue;
      const auto here = static_cast<std::size_t>(y * map.size + x);
      const auto there = static_cast<std::size_t>(v * map.size + u);
      if (map.known[here] == 0 || map.known[there] == 0) continue;
      const double p = map.rate[here], q = map.rate[there];
      n += 1, a += p, b += q, ab += p * q, aa += p * p, bb += q * q;
    }
  }
  if (n <= 30) return 0.0F;
  return static_cast<float>((n * ab - a * b) / std::sqrt((n * aa - a * a) * (n * bb - b * b)));
}

TEST(Autocorrelogram, IsTheCorrelationOfPairsOfKnownBins) {
  RateMap map = test::waves_map(24, 3, 9.0);
  for (std::size_t i = 0; i < map.known.size(); i += 7)
    map.known[i] = 0, map.rate[i] = 9.0F;  // must not count
  const Autocorrelogram found = autocorrelogram(map);
  ASSERT_EQ(found.radius, 17);
  for (int dy = -17; dy <= 17; ++dy) {
    for (int dx = -17; dx <= 17; ++dx)
      ASSERT_NEAR(found.at(dx, dy), naive_correlation(map, dx, dy), 2e-3) << dx << ' ' << dy;
  }
  EXPECT_NEAR(found.at(0, 0), 1.0F, 1e-6);
  EXPECT_EQ(found.at(5, -3), found.at(-5, 3));
}

TEST(Autocorrelogram, IsZeroWithoutChange) {
  const Autocorrelogram flat = autocorrelogram(test::made_map(20, [](double, double) { return 0.4; }));
  for (const float value : flat.values) EXPECT_EQ(value, 0.0F);
  RateMap unknown = test::waves_map(20, 3, 9.0);
  for (char& known : unknown.known) known = 0;
  for (const float value : autocorrelogram(unknown).values) EXPECT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace penumbra::slam::brain
