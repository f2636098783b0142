#include "slam/dynamics/instance_association.h"

#include <gtest/gtest.h>

namespace penumbra::slam {
namespace {

InstanceView view_at(int frame, int x, double depth) {
  InstanceView view;
  view.frame = frame;
  view.region = {x, 20, 40, 30};
  view.mask = ByteImage::filled(40, 30, 255);
  view.centre = {0.05 * x, 0.0, depth};
  view.nearest = depth - 1.0;
  view.farthest = depth + 1.0;
  return view;
}

Track track_of(const std::string& class_name, const InstanceView& view) {
  Track track;
  track.instance.class_name = class_name;
  track.views.push_back(view);
  return track;
}

class InstanceAssociation : public ::testing::Test {
 protected:
  InstanceAssociation() {
    for (int frame = 0; frame < 5; ++frame)
      history.begin(frame, 0.1 * frame, std::make_shared<FrameFeatures>(), SE3{});
    car.class_name = "car";
  }
  int owner(const InstanceView& view) const {
    return owner_of(car, view, tracks, std::vector<char>(tracks.size(), 0), history, settings);
  }

  InstanceTrackerSettings settings;
  FrameHistory history{60};
  std::vector<Track> tracks;
  Instance car;
};

TEST_F(InstanceAssociation, GoesByOverlapOfTheMasks) {
  tracks = {track_of("car", view_at(4, 100, 10.0)), track_of("car", view_at(4, 130, 10.0))};
  EXPECT_EQ(owner(view_at(4, 102, 10.0)), 0);
  EXPECT_EQ(owner(view_at(4, 127, 10.0)), 1);
  EXPECT_EQ(owner(view_at(4, 400, 10.0)), -1);
  EXPECT_EQ(owner_of(car, view_at(4, 102, 10.0), tracks, {1, 0}, history, settings), 1)
      << "the first is taken";
}

// Another class needs a clear overlap, and the same class is preferred.
TEST_F(InstanceAssociation, PrefersTheSameClass) {
  tracks = {track_of("truck", view_at(4, 100, 10.0)), track_of("car", view_at(4, 110, 10.0))};
  EXPECT_EQ(owner(view_at(4, 104, 10.0)), 1);
  tracks.pop_back();
  EXPECT_EQ(owner(view_at(4, 104, 10.0)), 0);
  EXPECT_EQ(owner(view_at(4, 135, 10.0)), -1) << "near, but no car";
}

TEST_F(InstanceAssociation, WhatCanMoveIsNothingThatCannot) {
  tracks = {track_of("chair", view_at(4, 100, 10.0))};
  EXPECT_EQ(owner(view_at(4, 100, 10.0)), -1);
  tracks = {track_of("", view_at(4, 100, 10.0))};
  EXPECT_EQ(owner(view_at(4, 100, 10.0)), 0) << "found by its motion, it may be anything";
}

TEST_F(InstanceAssociation, KnowsWhatIsOutOfSightByItsPlaceUnlessItMoves) {
  tracks = {track_of("car", view_at(2, 100, 10.0))};
  EXPECT_EQ(owner(view_at(4, 110, 10.2)), 0);
  EXPECT_EQ(owner(view_at(4, 110, 20.0)), -1) << "ten metres farther";
  tracks[0].instance.log_odds = 2.0;
  EXPECT_EQ(owner(view_at(4, 110, 10.2)), -1) << "it may be anywhere by now";
  tracks[0].instance.log_odds = 0.0;
  tracks[0].views.back().frame = -3;
  EXPECT_EQ(owner(view_at(4, 110, 10.2)), -1) << "its frame is forgotten";
}

// Behind a lorry that fills the view, a strip of the street was taken for the next cut of the lorry.
TEST_F(InstanceAssociation, WhatIsFurtherAwayIsAnotherThing) {
  for (const char* name : {"car", ""}) {
    tracks = {track_of(name, view_at(4, 100, 20.0))};
    EXPECT_EQ(owner(view_at(4, 100, 21.5)), 0);
    EXPECT_EQ(owner(view_at(4, 110, 2.0)), -1);
    EXPECT_EQ(owner(view_at(4, 101, 30.0)), 0) << "the same mask: its depth is uncertain";
    EXPECT_EQ(owner(view_at(4, 110, 30.0)), -1);
  }
}

TEST_F(InstanceAssociation, APartIsWhereItsWholeIs) {
  tracks = {track_of("truck", view_at(4, 100, 2.0))};
  const auto whole = [&](const InstanceView& view) { return whole_of(car, view, tracks, settings); };
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), nullptr) << "nothing is known of its motion";
  tracks[0].instance.log_odds = 3.0;
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), nullptr) << "it is only taken to move";
  tracks[0].instance.measured = true;
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), &tracks[0]) << "a metre beside it";
  EXPECT_EQ(whole(view_at(4, 150, 2.0)), nullptr);
  EXPECT_EQ(whole(view_at(4, 120, 5.0)), nullptr) << "behind it";
  EXPECT_EQ(whole(view_at(3, 120, 2.0)), nullptr) << "not in that frame";
  tracks[0].instance.part = true;
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), nullptr) << "itself only a part";
  tracks[0].instance.part = false;
  tracks[0].views[0].mask.row(0)[0] = 0;
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), nullptr) << "smaller than its part";
  tracks[0].views[0].mask.row(0)[0] = 255;
  tracks[0].instance.class_name = "person";
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), nullptr) << "a car beside somebody who walks";
  EXPECT_EQ(whole(view_at(4, 112, 2.0)), &tracks[0]) << "in it";
  settings.check_motion = false;
  EXPECT_EQ(whole(view_at(4, 112, 2.0)), nullptr) << "its class decides";
  settings.check_motion = true;
  car.class_name = "sign";
  EXPECT_EQ(whole(view_at(4, 120, 2.0)), nullptr) << "cannot move";
}

TEST_F(InstanceAssociation, ShowsAMoverThatIsKnown) {
  tracks = {track_of("truck", view_at(4, 100, 2.0))};
  const auto shows = [&](const InstanceView& view) {
    const int shown = owner(view);
    return shown >= 0 && tracks[static_cast<std::size_t>(shown)].is_known_to_move();
  };
  EXPECT_FALSE(shows(view_at(4, 102, 2.0)));
  tracks[0].instance.log_odds = 3.0;
  tracks[0].instance.measured = true;
  EXPECT_TRUE(shows(view_at(4, 102, 2.0)));
  EXPECT_FALSE(shows(view_at(4, 125, 2.0))) << "a part is new";
  EXPECT_FALSE(shows(view_at(4, 110, 20.0)));
  tracks.push_back(track_of("car", view_at(4, 126, 2.0)));
  EXPECT_FALSE(shows(view_at(4, 125, 2.0))) << "a car that nothing is known of";
}

TEST_F(InstanceAssociation, OfNothingIsNothing) { EXPECT_EQ(owner(view_at(4, 100, 10.0)), -1); }

}  // namespace
}  // namespace penumbra::slam
