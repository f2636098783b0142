// Each step of semi-global matching beside its formula, written down plainly.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "slam/frontend/disparity/chosen_disparity.h"
#include "slam/frontend/disparity/matching_cost.h"
#include "slam/frontend/disparity/path_costs.h"
#include "slam/frontend/disparity/speckles.h"

namespace penumbra::slam {
namespace {

struct Shape {
  int width, height, disparities;
};
constexpr Shape kShapes[] = {{1, 1, 8}, {1, 7, 8}, {9, 1, 16}, {2, 3, 8}, {31, 17, 24}, {40, 12, 32}};

ByteImage random_image(int width, int height, std::mt19937& random) {
  ByteImage image(width, height);
  for (std::size_t i = 0; i < image.elements(); ++i)
    image.data()[i] = static_cast<std::uint8_t>(random() % 7);
  return image;
}

template <class T>
DisparityVolume<T> random_volume(const Shape& shape, std::uint32_t end, std::mt19937& random) {
  DisparityVolume<T> volume;
  volume.create(shape.width, shape.height, shape.disparities);
  std::generate_n(volume.at(0, 0), shape.width * shape.height * shape.disparities,
                  [&] { return static_cast<T>(random() % end); });
  return volume;
}

TEST(Census, SaysWhichNeighboursAreDarker) {
  std::mt19937 random(1);
  for (const Shape& shape : kShapes) {
    const ByteImage image = random_image(shape.width, shape.height, random);
    CensusImage census;
    census_transform(image, census);
    for (int y = 0; y < shape.height; ++y) {
      for (int x = 0; x < shape.width; ++x) {
        std::uint32_t bits = 0;
        for (int dy = -2; dy <= 2; ++dy) {
          for (int dx = -2; dx <= 2; ++dx) {
            if (dx == 0 && dy == 0) continue;
            const int u = std::clamp(x + dx, 0, shape.width - 1), v = std::clamp(y + dy, 0, shape.height - 1);
            bits = 2 * bits + (image.at(u, v) < image.at(x, y));
          }
        }
        ASSERT_EQ(census.at(x, y), bits) << x << ' ' << y;
      }
    }
  }
}

TEST(Census, DoesNotKnowGainAndExposure) {
  std::mt19937 random(2);
  const ByteImage image = random_image(20, 10, random);
  ByteImage brighter = image.clone();
  for (std::size_t i = 0; i < brighter.elements(); ++i)
    brighter.data()[i] = static_cast<std::uint8_t>(3 * brighter.data()[i] + 40);
  CensusImage a, b;
  census_transform(image, a);
  census_transform(brighter, b);
  EXPECT_TRUE(std::equal(a.data(), a.data() + a.elements(), b.data()));
}

TEST(MatchingCost, CountsBitsThatDiffer) {
  std::mt19937 random(3);
  for (const Shape& shape : kShapes) {
    CensusImage left(shape.width, shape.height), right(shape.width, shape.height);
    for (CensusImage* image : {&left, &right})
      std::generate_n(image->data(), image->elements(), [&] { return random() & 0xFFFFFFU; });
    DisparityVolume<std::uint8_t> cost;
    matching_cost(left, right, shape.disparities, cost);
    for (int y = 0; y < shape.height; ++y) {
      for (int x = 0; x < shape.width; ++x) {
        for (int d = 0; d < shape.disparities; ++d) {
          const int bits = x < d ? 24 : std::popcount(left.at(x, y) ^ right.at(x - d, y));
          ASSERT_EQ(cost.at(x, y)[d], bits) << x << ' ' << y << ' ' << d;
        }
      }
    }
  }
}

// L_r of the whole image, for one direction.
std::vector<int> path_costs(const DisparityVolume<std::uint8_t>& cost, const PathPenalties& penalties, int dx,
                            int dy) {
  const int width = cost.width(), height = cost.height(), disparities = cost.disparities();
  std::vector<int> paths(static_cast<std::size_t>(width * height * disparities));
  const auto path = [&](int x, int y, int d) -> int& {
    return paths[static_cast<std::size_t>((y * width + x) * disparities + d)];
  };
  for (int row = 0; row < height; ++row) {
    const int y = dy >= 0 ? row : height - 1 - row;
    for (int column = 0; column < width; ++column) {
      const int x = dx >= 0 ? column : width - 1 - column;
      const int u = x - dx, v = y - dy;
      const bool inside = u >= 0 && v >= 0 && u < width && v < height;
      for (int d = 0; d < disparities; ++d) {
        path(x, y, d) = cost.at(x, y)[d];
        if (!inside) continue;
        int least = path(u, v, 0);
        for (int k = 1; k < disparities; ++k) least = std::min(least, path(u, v, k));
        int best = std::min(path(u, v, d), least + penalties.edge);
        if (d > 0) best = std::min(best, path(u, v, d - 1) + penalties.slope);
        if (d + 1 < disparities) best = std::min(best, path(u, v, d + 1) + penalties.slope);
        path(x, y, d) += best - least;
      }
    }
  }
  return paths;
}

TEST(PathCosts, AreTheSumsOverFourDirectionsEach) {
  std::mt19937 random(4);
  PathPass pass;
  for (const Shape& shape : kShapes) {
    const DisparityVolume<std::uint8_t> cost = random_volume<std::uint8_t>(shape, 25, random);
    const PathPenalties penalties{static_cast<int>(random() % 10), 10 + static_cast<int>(random() % 90)};
    for (const int way : {1, -1}) {
      std::vector<int> expected(static_cast<std::size_t>(shape.width * shape.height * shape.disparities));
      const int directions[4][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}};
      for (const auto& [dx, dy] : directions) {
        const std::vector<int> paths = path_costs(cost, penalties, way * dx, way * dy);
        for (std::size_t i = 0; i < paths.size(); ++i) expected[i] += paths[i];
      }
      DisparityVolume<std::int16_t> sum;
      pass.run(cost, penalties, way == 1 ? PathPass::Way::down : PathPass::Way::up, sum);
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), sum.at(0, 0)))
          << shape.width << 'x' << shape.height << ", way " << way;
    }
  }
}

float choice_at(const DisparityVolume<std::int16_t>& sum, const DisparityChoice& choice, int x, int y) {
  const int disparities = sum.disparities();
  const std::int16_t* const costs = sum.at(x, y);
  const int best = static_cast<int>(std::min_element(costs, costs + disparities) - costs);
  if (best == 0 || best == disparities - 1 || best > x) return 0.0F;
  for (int d = 0; d < disparities; ++d) {
    if (std::abs(d - best) > 1 && costs[d] < (1.0 + choice.unique) * costs[best]) return 0.0F;
  }
  // The right pixel's own choice, among the left ones that may show it.
  int right = -1, least = 1 << 20;
  for (int d = disparities - 1; d >= 0; --d) {
    const int u = x - best + d;
    if (u >= sum.width() || sum.at(u, y)[d] > least) continue;
    // Of equal ones the one that the left to right order comes to first: the smallest column.
    least = sum.at(u, y)[d];
    right = d;
  }
  if (std::abs(right - best) > choice.agree) return 0.0F;
  const float before = static_cast<float>(costs[best - 1] - costs[best]);
  const float after = static_cast<float>(costs[best + 1] - costs[best]);
  const float steep = std::max(before, after);
  return static_cast<float>(best) + (steep > 0.0F ? 0.5F * (before - after) / steep : 0.0F);
}

TEST(ChosenDisparity, IsTheCheapestThatBothImagesAgreeOn) {
  std::mt19937 random(5);
  int found = 0;
  for (const Shape& shape : kShapes) {
    const auto down = random_volume<std::int16_t>(shape, 300, random);
    const auto up = random_volume<std::int16_t>(shape, 300, random);
    DisparityVolume<std::int16_t> sum = down;
    for (int i = 0; i < shape.width * shape.height * shape.disparities; ++i)
      sum.at(0, 0)[i] = static_cast<std::int16_t>(sum.at(0, 0)[i] + up.at(0, 0)[i]);
    for (const DisparityChoice& choice : {DisparityChoice{0.0, 100}, {0.1, 2}, {0.05, 1}}) {
      FloatImage out;
      choose_disparities(down, up, choice, out);
      for (int y = 0; y < shape.height; ++y) {
        for (int x = 0; x < shape.width; ++x) {
          ASSERT_FLOAT_EQ(out.at(x, y), choice_at(sum, choice, x, y)) << x << ' ' << y;
          found += out.at(x, y) > 0.0F;
        }
      }
    }
  }
  EXPECT_GT(found, 100);
}

TEST(SpeckleFilter, RemovesSmallPiecesAlone) {
  FloatImage image = FloatImage::filled(12, 6, 0.0F);
  for (int x = 0; x < 12; ++x) image.at(x, 0) = 5.0F + 0.5F * static_cast<float>(x);  // a slope of 12
  for (int x = 2; x < 5; ++x) image.at(x, 2) = 9.0F;                                  // 3
  for (int x = 5; x < 8; ++x) image.at(x, 2) = 20.0F;                                 // 3 beside them
  for (int y = 4; y < 6; ++y) image.at(0, y) = image.at(1, y) = 7.0F;                 // 4 in a corner
  SpeckleFilter filter;
  filter.apply(image, 1.0F, 4);
  for (int x = 0; x < 12; ++x) EXPECT_GT(image.at(x, 0), 0.0F);
  for (int x = 0; x < 12; ++x) EXPECT_EQ(image.at(x, 2), 0.0F);
  EXPECT_EQ(image.at(1, 5), 7.0F);
  filter.apply(image, 0.4F, 2);  // now each pixel of the slope stands alone
  for (int x = 0; x < 12; ++x) EXPECT_EQ(image.at(x, 0), 0.0F);
  EXPECT_EQ(image.at(0, 4), 7.0F);
}

}  // namespace
}  // namespace penumbra::slam
