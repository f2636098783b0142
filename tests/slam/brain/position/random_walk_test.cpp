#include "slam/brain/position/random_walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace penumbra::slam::brain {
namespace {

TEST(RandomWalk, StaysInsideAndGoesItsSpeed) {
  for (const RoomShape shape : {RoomShape::square, RoomShape::hexagon, RoomShape::l_shape}) {
    const Room room(shape);
    RandomWalk walk(room, {}, 3);
    double heading = walk.heading();
    for (int i = 0; i < 5000; ++i) {
      const Eigen::Vector2d before = walk.position();
      walk.step();
      ASSERT_TRUE(room.contains(walk.position()));
      const Eigen::Vector2d way = walk.position() - before;
      if (way.norm() > 0.0) {
        ASSERT_NEAR(way.norm(), 0.015, 1e-12);
        ASSERT_NEAR(std::remainder(std::atan2(way.y(), way.x()) - walk.heading(), 6.283185307179586), 0.0,
                    1e-9);
      }
      ASSERT_NEAR(walk.turn_rate() * 0.05, walk.heading() - heading, 1e-12);
      heading = walk.heading();
    }
  }
}

// Every quarter of the square gets its share, and the turn rate wanders as its settings say.
TEST(RandomWalk, CoversTheRoomAndTurnsAsSet) {
  const Room room(RoomShape::square);
  RandomWalk walk(room, {}, 4);
  int quarters[4] = {};
  double squares = 0.0;
  int turns = 0;
  for (int i = 0; i < 40'000; ++i) {
    walk.step();
    ++quarters[(walk.position().x() > 0.0) + 2 * (walk.position().y() > 0.0)];
    if (std::abs(walk.turn_rate()) > 8.0) continue;  // at a wall
    squares += walk.turn_rate() * walk.turn_rate();
    ++turns;
  }
  for (const int visits : quarters) EXPECT_NEAR(visits / 40'000.0, 0.25, 0.08);
  EXPECT_NEAR(std::sqrt(squares / turns), 1.5, 0.1);
}

TEST(RandomWalk, RepeatsForASeed) {
  const Room room(RoomShape::hexagon);
  RandomWalk a(room, {}, 5), b(room, {}, 5), other(room, {}, 6);
  for (int i = 0; i < 100; ++i) a.step(), b.step(), other.step();
  EXPECT_EQ(a.position(), b.position());
  EXPECT_NE(a.position(), other.position());
}

TEST(RandomStream, IsNormal) {
  RandomStream random(7);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double z = random.normal();
    ASSERT_TRUE(std::isfinite(z));
    sum += z, squares += z * z;
  }
  EXPECT_NEAR(sum / 20'000, 0.0, 0.03);
  EXPECT_NEAR(squares / 20'000, 1.0, 0.04);
}

}  // namespace
}  // namespace penumbra::slam::brain
