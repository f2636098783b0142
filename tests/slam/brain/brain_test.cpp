#include "slam/brain/brain.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/image/blur.h"
#include "slam/brain/brain_recorder.h"
#include "slam/brain/motion/odometry_noise.h"
#include "tests/slam/brain/textured_room.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam::brain {
namespace {

using penumbra::test::expect_error;
using penumbra::test::TexturedRoom;

constexpr double kLap = 2.0 * std::numbers::pi * TexturedRoom::kRadius, kStep = 0.25;  // metres

BrainSettings intensity_settings() {
  BrainSettings settings;
  settings.templates = TemplateKind::intensity;
  settings.least_similarity = BrainSettings::least_profile_similarity;
  settings.away = 5.0;
  return settings;
}

// A robot that drives round the room; its gyroscope is off by 2 degrees a second, its wheels by 3 %.
class BrainInARoom : public ::testing::Test {
 protected:
  static OdometryNoise noise() {
    OdometryNoise noise;
    noise.scale = 0.03;
    noise.gyro_bias = 0.035;
    noise.white_speed = 0.01;
    noise.white_turn = 0.003;
    return noise;
  }
  // `laps` from `begin` metres on.
  void drive(Brain& brain, double laps, double begin = 0.0) {
    const int frames = static_cast<int>(laps * kLap / kStep);
    truth_ = TexturedRoom::truth(begin, kStep, frames);
    const std::vector<SelfMotion> motions = spoiled_odometry(truth_, noise(), 7);
    record_ = BrainRecorder();
    for (int i = 0; i < frames; ++i) {
      record_.add(brain.process(room_.images(TexturedRoom::pose(begin + kStep * i), i),
                                std::span(&motions[static_cast<std::size_t>(i)], 1)),
                  brain.map(), 0.0);
    }
    brain.finish();
  }
  // The landmarks of the drive that begins at `begin`.
  LandmarkFinder finder(double begin = 0.0) const {
    return [this, begin](const StereoImages& images, Landmarks& landmarks) {
      landmarks = room_.landmarks(TexturedRoom::pose(begin + kStep * images.index));
    };
  }
  // Of the trajectory's last frame, against the truth seen from its first one.
  double error_at_the_end(const Brain& brain) const {
    const Trajectory found = record_.trajectory(brain.map());
    const SE3 off = (truth_.front().T_wc.inverse() * truth_.back().T_wc).inverse() *
                    (found.front().T_wc.inverse() * found.back().T_wc);
    return off.translation.norm();
  }
  void expect_recalls_are_right() const {
    for (const Recall& recall : record_.recalls()) {
      const SE3 between = truth_[static_cast<std::size_t>(recall.earlier_frame)].T_wc.inverse() *
                          truth_[static_cast<std::size_t>(recall.frame)].T_wc;
      EXPECT_LT(between.translation.norm(), 4.0) << recall.frame << " as " << recall.earlier_frame;
    }
  }

  TexturedRoom room_;
  Trajectory truth_;
  BrainRecorder record_;
};

TEST_F(BrainInARoom, KnowsItsPlacesAgainByProfilesAndRepairsItsWay) {
  BrainSettings settings = intensity_settings();
  Brain brain(room_.camera(), Sensor::stereo, settings, {});
  drive(brain, 2.2);
  EXPECT_GT(record_.recalls().size(), 20U);
  expect_recalls_are_right();
  EXPECT_LT(error_at_the_end(brain), 0.6);
  // The second lap needs hardly any nodes of its own.
  Brain one_lap(room_.camera(), Sensor::stereo, settings, {});
  const int nodes = brain.map().size();
  drive(one_lap, 1.0);
  EXPECT_LT(nodes, 1.5 * one_lap.map().size());
}

TEST_F(BrainInARoom, KnowsItsPlacesAgainByLandmarks) {
  BrainSettings settings;
  settings.away = 5.0;
  Brain brain(room_.camera(), Sensor::stereo, settings, finder());
  drive(brain, 1.6);
  EXPECT_GT(record_.recalls().size(), 10U);
  expect_recalls_are_right();
  EXPECT_LT(error_at_the_end(brain), 0.6);
}

TEST_F(BrainInARoom, WithoutRecallItIsWhatWasFelt) {
  BrainSettings settings = intensity_settings();
  settings.recall = false;
  Brain brain(room_.camera(), Sensor::stereo, settings, {});
  drive(brain, 1.5);
  EXPECT_TRUE(record_.recalls().empty());
  EXPECT_GT(error_at_the_end(brain), 3.0);
  PlanePose felt;
  for (const SelfMotion& motion : spoiled_odometry(truth_, noise(), 7)) felt = felt * step_of(motion);
  const PlanePose found = plane_pose(record_.trajectory(brain.map()).back().T_wc);
  EXPECT_NEAR(found.x, felt.x, 1e-6);
  EXPECT_NEAR(found.y, felt.y, 1e-6);
}

TEST_F(BrainInARoom, IsTheSameWithOneAndTwoThreads) {
  Trajectory first;
  for (const int threads : {1, 2}) {
    BrainSettings settings = intensity_settings();
    settings.threads = threads;
    Brain brain(room_.camera(), Sensor::stereo, settings, {});
    drive(brain, 1.3);
    const Trajectory found = record_.trajectory(brain.map());
    if (threads == 1) first = found;
    ASSERT_EQ(found.size(), first.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_EQ(found[i].T_wc.translation, first[i].T_wc.translation) << "frame " << i;
  }
}

TEST_F(BrainInARoom, ABlurredKeyframeLeavesItsPlaceToTheFrameBefore) {
  Brain sharp(room_.camera(), Sensor::stereo, intensity_settings(), {});
  drive(sharp, 0.6);
  // One keyframe of the middle is blurred now.
  const std::vector<int> keyframes = record_.keyframes();
  const int blurred = keyframes[keyframes.size() / 2];
  const std::vector<SelfMotion> motions = spoiled_odometry(truth_, noise(), 7);
  Brain brain(room_.camera(), Sensor::stereo, intensity_settings(), {});
  for (int i = 0; i <= blurred; ++i) {
    StereoImages images = room_.images(TexturedRoom::pose(kStep * i), i);
    if (i == blurred) {
      const ByteImage sharp_image = images.left;
      GaussianBlur().apply(sharp_image.view(), images.left);
    }
    const BrainResult result =
        brain.process(std::move(images), std::span(&motions[static_cast<std::size_t>(i)], 1));
    EXPECT_EQ(result.blurred, i == blurred) << i;
  }
}

TEST_F(BrainInARoom, FindsItsWayInAMapThatWasSaved) {
  const test::TemporaryDirectory folder;
  BrainSettings settings = intensity_settings();
  {
    Brain brain(room_.camera(), Sensor::stereo, settings, {});
    drive(brain, 1.2);
    write_cognitive_map(folder / "room.brain", brain.stored());
  }
  const StoredMap stored = read_cognitive_map(folder / "room.brain");
  Brain brain(room_.camera(), Sensor::stereo, settings, {}, &stored);
  EXPECT_FALSE(brain.is_located());
  const double begin = 0.4 * kLap;
  drive(brain, 0.5, begin);
  EXPECT_TRUE(brain.is_located());
  // In the world of the map, whose origin is where the first drive began.
  const PlanePose found = plane_pose(record_.trajectory(brain.map()).back().T_wc);
  const PlanePose at = TexturedRoom::pose(0.0).inverse() *
                       TexturedRoom::pose(begin + kStep * static_cast<double>(truth_.size() - 1));
  EXPECT_LT(std::hypot(found.x - at.x, found.y - at.y), 0.6);
  for (const Recall& recall : record_.recalls()) EXPECT_TRUE(recall.loaded);
}

TEST_F(BrainInARoom, GoesOnWhereImagesAreMissing) {
  Brain brain(room_.camera(), Sensor::stereo, intensity_settings(), {});
  const SelfMotion ahead{1.0, 0.0, 0.5};
  EXPECT_EQ(brain.process_missing(0, 0.0, {}).anchor, 0);
  const BrainResult result = brain.process_missing(1, 0.5, std::span(&ahead, 1));
  EXPECT_NEAR(result.since_anchor.x, 0.5, 1e-6);
  EXPECT_FALSE(brain.process(room_.images(TexturedRoom::pose(0.0), 2), std::span(&ahead, 1)).blurred);
}

TEST_F(BrainInARoom, SaysWhatIsWrong) {
  expect_error<UsageError>([&] { Brain(room_.camera(), Sensor::stereo, {}, {}); }, {"network"});
  BrainSettings settings = intensity_settings();
  settings.keyframe_share = 0.0;
  expect_error<UsageError>([&] { Brain(room_.camera(), Sensor::stereo, settings, {}); },
                           {"keyframe_share", "0"});
  StoredMap other;
  other.camera = room_.camera();
  expect_error<InputError>([&] { Brain(room_.camera(), Sensor::stereo, intensity_settings(), {}, &other); },
                           {"intensity", "landmarks"});
  Brain brain(room_.camera(), Sensor::stereo, intensity_settings(), {});
  StereoImages images = room_.images(TexturedRoom::pose(0.0), 0);
  images.left = ByteImage::filled(100, 80, 9);
  expect_error<InputError>([&] { brain.process(std::move(images), {}); }, {"240x80", "100x80"});
}

}  // namespace
}  // namespace penumbra::slam::brain
