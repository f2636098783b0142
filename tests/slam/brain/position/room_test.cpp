#include "slam/brain/position/room.h"

#include <gtest/gtest.h>

#include <numbers>

#include "nn/base/error.h"

namespace penumbra::slam::brain {
namespace {

TEST(Room, KnowsWhatIsInside) {
  const Room square(RoomShape::square), hexagon(RoomShape::hexagon), l(RoomShape::l_shape);
  EXPECT_TRUE(square.contains({0.99, -0.99}));
  EXPECT_FALSE(square.contains({1.01, 0.0}));
  EXPECT_TRUE(hexagon.contains({1.1, 0.0}));
  EXPECT_FALSE(hexagon.contains({0.0, 1.1}));  // its sides are 1.0 away
  EXPECT_TRUE(l.contains({-0.5, 0.5}));
  EXPECT_TRUE(l.contains({0.5, -0.5}));
  EXPECT_FALSE(l.contains({0.5, 0.5}));
  for (const Room* room : {&square, &hexagon, &l}) EXPECT_TRUE(room->contains(room->start()));
}

TEST(Room, MeasuresTheWayToTheWallAhead) {
  const Room square(RoomShape::square), l(RoomShape::l_shape);
  EXPECT_NEAR(square.wall_ahead({0.25, 0.0}, 0.0), 0.75, 1e-12);
  EXPECT_NEAR(square.wall_ahead({0.0, 0.0}, std::numbers::pi / 4.0), std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(square.wall_ahead({0.0, 0.5}, -std::numbers::pi / 2.0), 1.5, 1e-12);
  EXPECT_NEAR(l.wall_ahead({-0.5, 0.5}, 0.0), 0.5, 1e-12);  // the inner wall
  EXPECT_NEAR(l.wall_ahead({-0.5, -0.5}, 0.0), 1.5, 1e-12);
  EXPECT_EQ(square.wall_ahead({2.0, 0.0}, 0.0), 9.0);  // none
}

TEST(Room, NamesItsShapes) {
  for (const char* name : {"square", "hexagon", "L"}) EXPECT_STREQ(to_string(parse_room(name)), name);
  EXPECT_THROW(parse_room("round"), UsageError);
}

}  // namespace
}  // namespace penumbra::slam::brain
