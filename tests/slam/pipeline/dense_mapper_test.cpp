#include "slam/pipeline/dense_mapper.h"

#include <gtest/gtest.h>

#include <deque>
#include <optional>

#include "tests/support/room_views.h"

namespace penumbra::slam {
namespace {

using namespace penumbra::test;

using Instances = std::optional<std::vector<Instance>>;  // none: the segmenter did not see the frame

// A run through the room whose frames, keyframes and masks are given.
class RoomRun {
 public:
  // `parked`: what is seen is followed, and was measured to stand.
  KeyFrame& add(const SE3& T_wc, bool pillar, const Instances& seen = {}, bool segmented = true,
                bool parked = false) {
    KeyFrame& reference = keyframes_.emplace_back();
    reference.T_cw = T_wc.inverse();
    FrameResult result;
    result.index = static_cast<int>(keyframes_.size()) - 1;
    result.timestamp = 0.1 * result.index;
    result.T_wc = T_wc;
    result.place.reference = &reference;
    result.segmented = segmented;
    result.tracking.state = TrackingState::tracking;
    if (seen) result.findings.segmented.push_back({result.index, *seen});
    if (parked) {
      InstanceSighting sighting;
      sighting.id = 1;
      sighting.region = seen->front().region;
      sighting.mask = seen->front().mask;
      result.findings.sightings.push_back({result.index, {sighting}});
      TrackedInstance track;
      track.id = 1;
      track.class_name = seen->front().class_name;
      track.measured = true;
      track.log_odds = -3.0;
      result.findings.gone.push_back(track);
    }
    StereoImages images;
    images.timestamp = result.timestamp;
    images.left = ByteImage::filled(kRoomCamera.width, kRoomCamera.height, 90);
    images.depth = room(T_wc, pillar);
    if (mapper_.add(kRoomCamera, images, result)) record_.keep_masks_of(result.index);
    record_.add(std::move(result));
    return reference;
  }
  static DenseSettings fine_settings() {
    DenseSettings settings;
    settings.fusion.voxel = 0.02;
    settings.step = 1;
    return with_derived(settings, Sensor::rgbd, kRoomCamera);
  }
  DenseMap build() { return mapper_.build(record_); }
  int views() const { return mapper_.views(); }

 private:
  Slam slam_{kRoomCamera, Sensor::rgbd, {}};
  Recorder record_{slam_};
  DenseMapper mapper_{fine_settings()};
  std::deque<KeyFrame> keyframes_;
};

// The pillar as the camera at `x` sees it.
Instances pillar_as(const char* name, double x) {
  const int left = static_cast<int>(std::lround(79.5 - 160.0 * (0.2 + x) / 1.5));
  return std::vector<Instance>{
      {.class_name = name, .region = {left, 0, 44, 120}, .mask = ByteImage::filled(44, 120, 255)}};
}

// Voxels of the pillar, without its foot, which is near to the floor behind it.
std::ptrdiff_t on_pillar(const DenseMap& map) {
  return std::count_if(map.voxels.voxels().begin(), map.voxels.voxels().end(), [](const Voxel& v) {
    return off_surface(v) > 0.1 && v.place.y() < kAboveFloor - 0.25;
  });
}

TEST(DenseMapper, MakesAMapOfAFewKeyframes) {
  RoomRun run;
  for (const double x : {-0.1, 0.0, 0.1}) run.add(at(x), false);
  run.add(at(0.11), false);            // too near to the last
  run.add(at(0.3), false, {}, false);  // not shown to the segmenter
  EXPECT_EQ(run.views(), 3);
  const DenseMap map = run.build();
  EXPECT_EQ(map.views, 3);
  EXPECT_GT(map.voxels.voxels().size(), 10'000U);
  for (const Voxel& voxel : map.voxels.voxels()) EXPECT_LT(off_surface(voxel), 0.003);
  ASSERT_TRUE(map.floor.has_value());
  EXPECT_NEAR(map.floor->height({0.0, 0.0, 0.0}), kAboveFloor, 0.005);
  EXPECT_TRUE(map.plan.has_value());
  EXPECT_EQ(map.classes, std::vector<std::string>{""});
}

TEST(DenseMapper, LeavesOutPeopleAndKeepsThingsWithTheirClass) {
  for (const bool person : {true, false}) {
    RoomRun run;
    for (const double x : {-0.1, 0.0, 0.1}) run.add(at(x), true, pillar_as(person ? "person" : "box", x));
    const DenseMap map = run.build();
    if (person) {
      EXPECT_LT(on_pillar(map), 10);
      continue;
    }
    EXPECT_GT(on_pillar(map), 200);
    EXPECT_EQ(map.classes, (std::vector<std::string>{"", "box"}));
    EXPECT_GT(std::count_if(map.voxels.voxels().begin(), map.voxels.voxels().end(),
                            [](const Voxel& v) { return v.class_id == 1; }),
              200);
  }
}

TEST(DenseMapper, KeepsVehiclesThatWereSeenToStand) {
  for (const bool parked : {false, true}) {
    RoomRun run;
    for (const double x : {-0.1, 0.0, 0.1}) run.add(at(x), true, pillar_as("car", x), true, parked);
    const DenseMap map = run.build();
    EXPECT_EQ(on_pillar(map) > 200, parked);
    EXPECT_EQ(on_pillar(map) < 10, !parked);
  }
  RoomRun people;
  for (const double x : {-0.1, 0.0, 0.1}) people.add(at(x), true, pillar_as("person", x), true, true);
  EXPECT_LT(on_pillar(people.build()), 10);
}

TEST(DenseMapper, LeavesOutAThingWhereItStoodBefore) {
  RoomRun run;
  for (const double x : {0.0, 0.06, 0.12}) run.add(at(x), true, pillar_as("box", x));
  for (const double x : {0.18, 0.24}) run.add(at(x), false, std::vector<Instance>{});
  EXPECT_LT(on_pillar(run.build()), 10);
}

TEST(DenseMapper, KeepsAThingThatOneOfManyViewsShows) {
  RoomRun run;
  run.add(at(0.0), true, pillar_as("box", 0.0));
  for (const double x : {0.0, 0.1, 0.2, 0.3, 0.4}) run.add(at(x, 2.0), true, std::vector<Instance>{});
  EXPECT_GT(on_pillar(run.build()), 200);
}

TEST(DenseMapper, MovesWithItsKeyframesAndTheStandInsOfErasedOnes) {
  RoomRun run;
  KeyFrame& first = run.add(at(0.0), false);
  KeyFrame& second = run.add(at(0.1), false);
  second.T_c_stand_in = second.T_cw * first.T_cw.inverse();
  second.stand_in = &first;
  second.erased = true;
  second.T_cw = {};
  first.T_cw = at(0.0, 1.0).inverse();  // as after a loop
  const DenseMap map = run.build();
  EXPECT_EQ(map.views, 2);
  EXPECT_GT(map.voxels.voxels().size(), 10'000U);
  for (const Voxel& voxel : map.voxels.voxels()) {
    EXPECT_LT(std::min(std::abs(voxel.place.y() - kAboveFloor), std::abs(voxel.place.z() - 4.0)), 0.003);
  }
}

// Somebody stands where the pillar is; views that the segmenter did not see count where no view that it saw
// shows the same, however many it saw.
TEST(DenseMapper, LeavesOutUnsegmentedViewsOnlyBesideSegmentedOnes) {
  for (const int unsegmented : {1, 2, 3}) {  // beside two that are segmented
    RoomRun run;
    for (const double x : {0.0, 0.06}) run.add(at(x), true, pillar_as("person", x));
    for (int i = 0; i < unsegmented; ++i) run.add(at(0.12 + 0.06 * i), true);
    EXPECT_LT(on_pillar(run.build()), 10) << unsegmented;
    run.add(at(-0.8), false);  // which sees more of the floor on the left
    const DenseMap map = run.build();
    EXPECT_TRUE(std::any_of(map.voxels.voxels().begin(), map.voxels.voxels().end(), [](const Voxel& v) {
      return v.place.x() < -1.9F;
    })) << unsegmented;
  }
  RoomRun never;  // nothing was segmented
  for (const double x : {0.0, 0.06}) never.add(at(x), true);
  EXPECT_GT(on_pillar(never.build()), 200);
}

}  // namespace
}  // namespace penumbra::slam
