#include "slam/frontend/features/feature_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace penumbra::slam {
namespace {

class FeatureGridTest : public ::testing::Test {
 protected:
  FeatureGridTest() {
    for (int i = 0; i < 1500; ++i)
      keypoints.push_back(
          {number(0.0F, 640.0F), number(0.0F, 240.0F), static_cast<int>(random() % 8), 0.0F, 1.0F});
    grid = FeatureGrid(keypoints, 640, 240);
  }
  float number(float from, float to) { return std::uniform_real_distribution<float>(from, to)(random); }

  std::mt19937 random{1};
  std::vector<Keypoint> keypoints;
  FeatureGrid grid;
};

TEST_F(FeatureGridTest, FindsWhatIsInTheSquareWithItsLevel) {
  for (int n = 0; n < 300; ++n) {
    const float u = number(-30.0F, 670.0F), v = number(-30.0F, 270.0F), radius = number(0.0F, 80.0F);
    std::vector<int> found, naive;
    grid.visit_near(u, v, radius, [&](int i, int level) {
      EXPECT_EQ(level, keypoints[std::size_t(i)].level);
      found.push_back(i);
    });
    for (int i = 0; i < static_cast<int>(keypoints.size()); ++i) {
      const Keypoint& k = keypoints[std::size_t(i)];
      if (std::abs(k.u - u) <= radius && std::abs(k.v - v) <= radius) naive.push_back(i);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, naive);
  }
}

// Along a line it has all that is near the line, in the same order, and little else.
TEST_F(FeatureGridTest, FindsWhatIsNearALine) {
  std::size_t all = 0, along = 0;
  for (int n = 0; n < 500; ++n) {
    const float u = number(0.0F, 640.0F), v = number(0.0F, 240.0F), radius = number(5.0F, 80.0F),
                margin = number(1.0F, 12.0F);
    const float angle = number(0.0F, 6.3F), size = number(1e-6F, 1e3F);
    std::array<float, 3> line{size * std::cos(angle), size * std::sin(angle), 0.0F};
    if (n % 20 == 0) line = {0.0F, size, 0.0F};  // a row
    if (n % 20 == 1) line = {size, 0.0F, 0.0F};  // a column
    if (n % 20 == 2) line = {1e-3F * size, size, 0.0F};
    line[2] = -(line[0] * (u + number(-20.0F, 20.0F)) + line[1] * (v + number(-20.0F, 20.0F)));
    if (n % 20 == 3) line = {0.0F, 0.0F, 0.0F};  // none
    std::vector<int> square, band;
    grid.visit_near(u, v, radius, [&](int i) { square.push_back(i); });
    grid.visit_near_line(u, v, radius, line, margin, [&](int i) { band.push_back(i); });
    auto at = band.begin();
    for (const int i : square) {
      const bool is_found = at != band.end() && *at == i;
      at += is_found;
      const Keypoint& k = keypoints[std::size_t(i)];
      const float length = std::hypot(line[0], line[1]);
      const float distance =
          length > 0.0F ? std::abs(line[0] * k.u + line[1] * k.v + line[2]) / length : 0.0F;
      if (distance <= 0.99F * margin) {
        EXPECT_TRUE(is_found) << n;
      }
    }
    EXPECT_EQ(at, band.end()) << "nothing else";
    all += square.size();
    along += band.size();
  }
  EXPECT_LT(along, 7 * all / 10);
}

}  // namespace
}  // namespace penumbra::slam
