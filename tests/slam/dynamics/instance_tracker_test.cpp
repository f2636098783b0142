#include "slam/dynamics/instance_tracker.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "slam/dynamics/movers.h"
#include "slam/frontend/features/image_pyramid.h"
#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

constexpr double kStep = 0.8;  // metres that the camera goes ahead from frame to frame, at 10 Hz

// A feature at `pixel` (u, v and u in the right image), `depth` metres away; its looks depend on `key` alone.
void add_feature(const Eigen::Vector3d& pixel, double depth, std::uint64_t key, FrameFeatures& features) {
  features.left.keypoints.push_back(
      {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), 0, 0.0F, 1.0F});
  Descriptor descriptor{};
  for (std::size_t w = 0; w < descriptor.size(); ++w) descriptor[w] = counter_random(7 + w, key);
  features.left.descriptors.push_back(descriptor);
  features.u_right.push_back(static_cast<float>(pixel.z()));
  features.depth.push_back(static_cast<float>(depth));
}

// What depends on all features.
void complete(const StereoCamera& camera, FrameFeatures& features) {
  features.grid = FeatureGrid(features.left.keypoints, camera.width, camera.height);
}

// A wall of points 30 m ahead of the first frame and a box of points, which the camera drives towards.
class Street {
 public:
  explicit Street(double box_speed) : camera_(test::test_camera()), box_speed_(box_speed) {}
  const StereoCamera& camera() const { return camera_; }
  Eigen::Vector3d box(int frame) const { return {1.0, 0.5, 12.0 + (0.1 * box_speed_ - kStep) * frame}; }

  std::shared_ptr<const FrameFeatures> features(int frame) const {
    auto features = std::make_shared<FrameFeatures>();
    for (int i = 0; i < 120; ++i) {
      const bool on_box = i < 40;
      const auto k = static_cast<std::uint64_t>(i);
      const auto draw = [&](std::uint64_t axis, double reach) {
        return reach * (static_cast<double>(counter_random(axis, k) % 1000) / 500.0 - 1.0);
      };
      const Eigen::Vector3d p =
          on_box ? Eigen::Vector3d(box(frame) + Eigen::Vector3d(draw(1, 0.9), draw(2, 0.7), 0))
                 : Eigen::Vector3d(draw(1, 9.0), draw(2, 2.5), 30.0 - kStep * frame);
      const Eigen::Vector3d pixel = camera_.project_stereo(p);
      if (!camera_.in_image(pixel.head<2>())) continue;
      if (!on_box && hidden(frame, pixel.head<2>())) continue;
      add_feature(pixel, p.z(), k, *features);
    }
    complete(camera_, *features);
    return features;
  }
  bool hidden(int frame, const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d reach(1.2, 1.0, 0.0);
    const Eigen::Vector2d corner = camera_.project(box(frame) - reach),
                          end = camera_.project(box(frame) + reach);
    return (pixel.array() >= corner.array()).all() && (pixel.array() <= end.array()).all();
  }
  Instance instance(int frame, const std::string& name) const {
    const Eigen::Vector2d corner = camera_.project(box(frame) - Eigen::Vector3d(1.0, 0.8, 0.0));
    const Eigen::Vector2d end = camera_.project(box(frame) + Eigen::Vector3d(1.0, 0.8, 0.0));
    Instance instance;
    instance.class_name = name;
    instance.score = 0.9F;
    const auto whole = [](double pixel) { return static_cast<int>(std::lrint(pixel)); };
    const int x = whole(corner.x()), y = whole(corner.y());
    instance.region =
        intersection({x, y, whole(end.x()) - x, whole(end.y()) - y}, {0, 0, camera_.width, camera_.height});
    instance.mask = ByteImage::filled(instance.region.width, instance.region.height, 255);
    return instance;
  }

 private:
  StereoCamera camera_;
  double box_speed_;
};

SE3 ahead() {
  SE3 T;
  T.translation.z() = -kStep;
  return T;
}

// A frame that was located where it was predicted.
void show(InstanceTracker& tracker, Movers& movers, int frame, std::shared_ptr<const FrameFeatures> features,
          const SE3& T_step, bool reliable = true) {
  std::vector<char> movable;
  const FrameBeforePose before{frame, 0.1 * frame, std::move(features), T_step};
  tracker.before_pose(before, movable);
  movers.before_pose(before, movable);
  const FrameAfterPose after{T_step, reliable, nullptr, std::nullopt};
  tracker.after_pose(after, movable);
  for (const Instance& mover : movers.after_pose(after, movable)) tracker.add_mover(frame, mover);
}

class Drive {
 public:
  Drive(double box_speed, const InstanceTrackerSettings& settings = {}, int first_number = 0)
      : street(box_speed),
        tracker(street.camera(), level_scales({}), settings, first_number),
        movers(street.camera(), level_scales({}), settings.companions, settings.motion) {}
  void to(int frames) {
    for (; frame < frames; ++frame) {
      show(tracker, movers, frame, street.features(frame), frame == 0 ? SE3{} : ahead());
    }
  }
  int marked() const {
    return static_cast<int>(std::count(tracker.movable().begin(), tracker.movable().end(), 1));
  }

  Street street;
  InstanceTracker tracker;
  Movers movers;
  int frame = 0;
};

InstanceTrackerSettings masks_only() {
  InstanceTrackerSettings settings;
  settings.companions.enabled = false;
  return settings;
}

InstanceTrackerSettings by_class_alone() {
  InstanceTrackerSettings settings = masks_only();
  settings.check_motion = false;
  return settings;
}

TEST(InstanceTracker, SeesThatAParkedCarStands) {
  Drive drive(0.0, masks_only());
  drive.to(6);
  drive.tracker.add(5, {drive.street.instance(5, "car")});
  ASSERT_EQ(drive.tracker.instances().size(), 1U);
  EXPECT_EQ(drive.tracker.instances()[0].state(), MotionState::still);
  drive.to(8);
  EXPECT_EQ(drive.marked(), 0);
  EXPECT_LT(drive.tracker.instances()[0].velocity.norm(), 0.1);
}

TEST(InstanceTracker, SeesThatACarMovesAndCarriesItsMask) {
  Drive drive(8.0, masks_only());
  drive.to(6);
  drive.tracker.add(4, {drive.street.instance(4, "car")});  // a frame late
  ASSERT_EQ(drive.tracker.instances().size(), 1U);
  const TrackedInstance car = drive.tracker.instances()[0];
  EXPECT_EQ(car.state(), MotionState::moving);
  EXPECT_GT(car.moving_probability(), 0.9);
  drive.to(12);
  EXPECT_NEAR(drive.tracker.instances()[0].velocity.z(), 8.0, 0.5);
  EXPECT_EQ(drive.marked(), 40);
  EXPECT_GT(drive.tracker.covered_share(), 0.005);
  ASSERT_EQ(drive.tracker.sightings().size(), 1U);
  EXPECT_NEAR(drive.tracker.sightings()[0].centre.z(), 12.0, 0.5);
}

// A detector that gives the parts of what it has found before: they are not of unknown motion.
TEST(InstanceTracker, APartOfACarThatMovesMoves) {
  InstanceTrackerSettings settings = masks_only();
  settings.frames_back = 0;  // nothing can be learned of the part itself
  Drive drive(8.0, settings);
  drive.to(4);
  drive.tracker.add(3, {drive.street.instance(3, "car")});
  drive.to(11);
  drive.tracker.add(10, {drive.street.instance(10, "car")});
  ASSERT_GT(drive.tracker.instances()[0].log_odds, 3.0);
  Instance part = drive.street.instance(10, "truck");
  part.region.width /= 4;
  part.mask = ByteImage::filled(part.region.width, part.region.height, 255);
  part.score = 0.6F;
  drive.tracker.add(10, {part, drive.street.instance(10, "car")});
  const std::vector<TrackedInstance> found = drive.tracker.instances();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].class_name, "truck");
  EXPECT_EQ(found[1].log_odds, found[0].log_odds);
  EXPECT_TRUE(found[1].part);
}

TEST(InstanceTracker, LessCertainDetectionsShowOnlyWhatIsKnownToMove) {
  for (const double speed : {8.0, 0.0}) {
    Drive drive(speed, masks_only());
    Instance weak = drive.street.instance(6, "car");
    weak.score = 0.35F;
    drive.to(7);
    drive.tracker.add(6, {weak});
    EXPECT_TRUE(drive.tracker.instances().empty()) << speed;
    drive.tracker.add(5, {drive.street.instance(5, "car")});
    drive.tracker.add(6, {weak});
    ASSERT_EQ(drive.tracker.instances().size(), 1U) << speed;
    EXPECT_EQ(drive.tracker.instances()[0].detections, speed > 0.0 ? 2 : 1);
  }
}

TEST(InstanceTracker, ACarThatIsSeenMovingIsThereThoughNotFoundAgain) {
  for (const double speed : {8.0, 0.0}) {
    Drive drive(speed, masks_only());
    drive.to(6);
    drive.tracker.add(5, {drive.street.instance(5, "car")});
    for (int frame = 6; frame < 12; ++frame) {
      drive.to(frame + 1);
      drive.tracker.add(frame, {});
    }
    EXPECT_EQ(drive.tracker.sightings().size(), speed > 0.0 ? 1U : 0U) << speed;
  }
}

TEST(InstanceTracker, ByClassAloneEverythingThatCanMoveIsLeftOut) {
  Drive drive(0.0, by_class_alone());
  drive.to(6);
  drive.tracker.add(5, {drive.street.instance(5, "car")});
  drive.to(7);
  EXPECT_EQ(drive.marked(), 40);
}

TEST(InstanceTracker, ByClassAloneABetterViewDecidesWhatItIs) {
  Drive drive(0.0, by_class_alone());
  Instance first = drive.street.instance(5, "car");
  first.score = 0.6F;
  drive.to(6);
  drive.tracker.add(5, {first});
  const double of_a_car = drive.tracker.instances()[0].moving_probability();
  drive.to(7);
  drive.tracker.add(6, {drive.street.instance(6, "person")});
  ASSERT_EQ(drive.tracker.instances().size(), 1U);
  EXPECT_EQ(drive.tracker.instances()[0].class_name, "person");
  EXPECT_GT(drive.tracker.instances()[0].moving_probability(), of_a_car) << "people usually move";
}

TEST(InstanceTracker, ByClassAloneSomebodyBeforeAChairIsLeftOut) {
  Drive drive(0.0, by_class_alone());
  drive.to(6);
  drive.tracker.add(5, {drive.street.instance(5, "chair")});
  drive.to(7);
  EXPECT_EQ(drive.marked(), 0);
  drive.tracker.add(6, {drive.street.instance(6, "person")});
  drive.to(8);
  EXPECT_EQ(drive.marked(), 40);
}

TEST(InstanceTracker, KeepsTheIdentityOverSeveralDetections) {
  Drive drive(8.0, masks_only());
  for (const int frame : {3, 6, 9}) {
    drive.to(frame + 1);
    drive.tracker.add(frame, {drive.street.instance(frame, "car")});
  }
  ASSERT_EQ(drive.tracker.instances().size(), 1U);
  EXPECT_EQ(drive.tracker.instances()[0].detections, 3);
  EXPECT_GT(drive.tracker.instances()[0].visible_share, 0.9);
}

TEST(InstanceTracker, TellsTheMapWhatMovedInAKeyframe) {
  Drive drive(8.0, masks_only());
  KeyFrame keyframe;
  drive.to(5);
  drive.tracker.set_keyframe(&keyframe);
  drive.tracker.add(4, {drive.street.instance(4, "car")});
  const std::vector<MovingFeatures> moving = drive.tracker.take_edits().moving;
  ASSERT_FALSE(moving.empty());
  EXPECT_EQ(moving[0].keyframe, &keyframe);
  EXPECT_EQ(moving[0].features.size(), 40U);
  EXPECT_EQ(drive.marked(), 0);  // a keyframe's features are the map's
  EXPECT_TRUE(drive.tracker.take_edits().moving.empty());
}

TEST(InstanceTracker, TellsTheMapTheObjectsOfAKeyframe) {
  for (const double speed : {0.0, 8.0}) {
    Drive drive(speed, masks_only(), 7);
    KeyFrame keyframe;
    drive.to(6);
    drive.tracker.set_keyframe(&keyframe);
    EXPECT_TRUE(drive.tracker.take_keyframe_objects().empty()) << "nothing was found yet";
    for (const int frame : {5, 8, 11}) {  // each look at what moves, or stands, is some more evidence
      drive.to(frame + 1);
      drive.tracker.add(frame, {drive.street.instance(frame, "car")});
    }
    const std::vector<KeyframeObjects> told = drive.tracker.take_keyframe_objects();
    ASSERT_EQ(told.size(), 1U);
    EXPECT_EQ(told[0].keyframe, &keyframe);
    ASSERT_EQ(told[0].objects.size(), 1U);
    const SeenObject& car = told[0].objects[0];
    EXPECT_EQ(car.number, 7);
    EXPECT_EQ(car.class_name, "car");
    EXPECT_NEAR(car.position.z(), drive.street.box(5).z(), 0.5);
    EXPECT_EQ(car.region, drive.street.instance(5, "car").region);
    EXPECT_EQ(car.stands, speed == 0.0);
    EXPECT_TRUE(drive.tracker.take_keyframe_objects().empty()) << "nothing has changed";
  }
}

TEST(InstanceTracker, FindsACompanionWithoutMasks) {
  Drive drive(8.0);
  drive.to(12);
  ASSERT_FALSE(drive.tracker.instances().empty());
  EXPECT_EQ(drive.tracker.instances()[0].state(), MotionState::moving);
  drive.to(13);
  EXPECT_GE(drive.marked(), 36);
  EXPECT_LE(drive.marked(), 44);
}

TEST(InstanceTracker, FindsNoCompanionWhereAllStands) {
  Drive drive(0.0);
  drive.to(20);
  EXPECT_TRUE(drive.tracker.instances().empty());
}

// Posts beside the road that look the same and come by at the step of the frames: each stands in the image
// where the one before it stood.
TEST(InstanceTracker, TakesNoFenceForACompanion) {
  const StereoCamera camera = test::test_camera();
  InstanceTracker tracker(camera, level_scales({}), {});
  Movers movers(camera, level_scales({}), {}, {});
  for (int frame = 0; frame < 20; ++frame) {
    auto features = std::make_shared<FrameFeatures>();
    for (int post = 0; post < 30; ++post) {
      for (std::uint64_t height = 0; height < 4; ++height) {
        const Eigen::Vector3d p(3.0, 0.3 * static_cast<double>(height) - 0.5, 1.6 + kStep * post);
        const Eigen::Vector3d pixel = camera.project_stereo(p);
        if (!camera.in_image(pixel.head<2>())) continue;
        add_feature(pixel, p.z(), height, *features);
      }
    }
    complete(camera, *features);
    show(tracker, movers, frame, features, frame == 0 ? SE3{} : ahead());
  }
  EXPECT_TRUE(tracker.instances().empty());
}

// A car is found, driven past, and another comes: each is told once when nobody can find it again.
TEST(InstanceTracker, ForgetsWhatHasGoneForGood) {
  InstanceTrackerSettings settings = masks_only();
  settings.history = 10;
  const StereoCamera camera = test::test_camera();
  InstanceTracker tracker(camera, level_scales({}), settings);
  Movers movers(camera, level_scales({}), settings.companions, settings.motion);
  constexpr int kCars = 20, kFrames = 30;  // a car is in view for a dozen
  int gone = 0;
  for (int car = 0; car < kCars; ++car) {
    const Street street(0.0);
    for (int k = 0; k < kFrames; ++k) {
      const int frame = car * kFrames + k;
      auto features = std::make_shared<FrameFeatures>();
      if (k < 12) *features = *street.features(k);
      if (k >= 12) complete(camera, *features);
      show(tracker, movers, frame, features, k == 0 ? SE3{} : ahead(), k > 0 && k < 12);
      if (k == 4) {
        Instance found = street.instance(k, "car");
        tracker.add(frame, {found});
      }
      for (const TrackedInstance& instance : tracker.take_gone()) {
        EXPECT_EQ(instance.id, gone++);
        EXPECT_EQ(instance.class_name, "car");
      }
      EXPECT_LE(tracker.instances().size(), 2U);
    }
  }
  EXPECT_GE(gone, kCars - 2);
  EXPECT_EQ(gone + static_cast<int>(tracker.instances().size()), kCars);
}

TEST(InstanceTracker, IgnoresWeakInstancesAndForgottenFrames) {
  Drive drive(8.0, masks_only());
  drive.to(4);
  Instance weak = drive.street.instance(3, "car");
  weak.score = 0.2F;
  drive.tracker.add(3, {weak});
  drive.tracker.add(77, {drive.street.instance(3, "car")});
  Instance empty = drive.street.instance(3, "car");
  empty.region = {0, 0, 4, 4};
  empty.mask = ByteImage::filled(4, 4, 255);
  drive.tracker.add(3, {empty});
  EXPECT_TRUE(drive.tracker.instances().empty());
}

}  // namespace
}  // namespace penumbra::slam
