#include "slam/map/dense/displaced.h"

#include <gtest/gtest.h>

#include "tests/support/room_views.h"

namespace penumbra::slam {
namespace {

using namespace penumbra::test;

// Columns within 0.2 m of the middle at 1.5 m, above its foot, which is near to the floor behind it.
const Rect kPillar{58, 0, 44, 90};

// Whether the first view's pillar is elsewhere in the others.
bool is_displaced(const RoomViews& views) {
  const ByteImage mask = ByteImage::filled(22, 45, 255);
  const ShownThing things[] = {{0, kPillar, &mask}};
  return find_displaced(things, views.posed(), {}).front() != 0;
}

TEST(Displaced, IsWhatOtherViewsContradict) {
  const auto judged = [&](const std::vector<bool>& pillar) {
    RoomViews views;
    double x = 0.0;
    for (const bool there : pillar) views.add(at(x += 0.02), there);
    return is_displaced(views);
  };
  EXPECT_FALSE(judged({true, true, true, true}));
  EXPECT_FALSE(judged({true, true, true, false}));
  EXPECT_TRUE(judged({true, true, true, false, false}));
  EXPECT_TRUE(judged({true, false, false}));
  EXPECT_TRUE(judged({true, false}));  // nobody confirms it
  EXPECT_FALSE(judged({true}));
}

TEST(Displaced, ViewsThatLookAwaySayNothing) {
  RoomViews views;
  views.add(at(0.0), true);
  for (int i = 0; i < 5; ++i) views.add(at(0.0, 2.0), true);  // behind the pillar
  SE3 turned = at(0.0);
  turned.rotation = so3_exp({0.0, 1.4, 0.0});
  views.add(turned, false);
  EXPECT_FALSE(is_displaced(views));
  views.add(at(0.02), false);
  EXPECT_TRUE(is_displaced(views));
}

TEST(Displaced, ViewsInWhichSomethingStandsBeforeItSayNothing) {
  RoomViews views;
  views.add(at(0.0), true);
  for (int i = 0; i < 5; ++i) {
    views.add(at(0.0), true);
    views.kept.back() =
        make_dense_view(kRoomCamera, ByteImage::filled(160, 120, 90), FloatImage::filled(160, 120, 0.8F), 1);
  }
  EXPECT_FALSE(is_displaced(views));
}

TEST(Displaced, AsksSomeOfManyViews) {
  // The last fifth of many views looks through it.
  RoomViews views;
  for (int i = 0; i < 200; ++i) views.add(at(0.0005 * i), i < 160);
  EXPECT_TRUE(is_displaced(views));
}

TEST(Displaced, JudgesEachThingOnItsOwn) {
  RoomViews views;
  for (const bool pillar : {true, true, false, false}) views.add(at(0.02 * views.kept.size()), pillar);
  const ByteImage mask = ByteImage::filled(22, 45, 255), none;
  const ShownThing things[] = {
      {0, kPillar, &mask}, {3, kPillar, &mask}, {0, {}, &none}, {1, {0, 0, 30, 40}, &mask}};
  // The pillar, the wall behind it (which two views hide), nothing, and the wall beside it.
  EXPECT_EQ(find_displaced(things, views.posed(), {}), (std::vector<char>{1, 0, 0, 0}));
  EXPECT_TRUE(find_displaced({}, views.posed(), {}).empty());
}

}  // namespace
}  // namespace penumbra::slam
