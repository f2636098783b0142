#include "slam/backend/full_bundle_adjustment.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "tests/slam/backend/mapped_drive.h"

namespace penumbra::slam {
namespace {

// A dozen keyframes whose poses, and the points they see, are a little off.
class FullBundle : public ::testing::Test {
 protected:
  FullBundle() {
    test::DriftingDrive drive(world, map, Vector6d::Zero());
    for (int k = 0; k < 12; ++k) drive.add_keyframe(k);
    settings.disparity_offset_sigma = 0.0;
  }
  static double noise(std::uint64_t seed, std::uint64_t i) { return 2.0 * counter_uniform(seed, i) - 1.0; }
  void disturb() {
    for (KeyFrame* keyframe : map.keyframes()) {
      if (keyframe->id == 0) continue;
      Vector6d motion;
      for (int k = 0; k < 6; ++k)
        motion[k] = (k < 3 ? 0.05 : 0.005) * noise(3, static_cast<std::uint64_t>(6 * keyframe->id + k));
      keyframe->T_cw = SE3::exp(motion) * keyframe->T_cw;
    }
    for (const auto& point : map.points()) {
      const auto i = static_cast<std::uint64_t>(3 * point->id);
      point->position += 0.1 * Eigen::Vector3d(noise(4, i), noise(4, i + 1), noise(4, i + 2));
    }
  }
  // Metres, root mean square, of the keyframes.
  double error() const {
    double sum = 0.0;
    for (const KeyFrame* k : map.keyframes()) {
      const SE3 truth = world.T_cw(k->frame_index);
      sum += (k->T_cw.inverse().translation - truth.inverse().translation).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(map.keyframes().size()));
  }
  FullBundleReport adjust(const std::atomic<bool>* stop = nullptr) {
    FullBundleAdjustment adjustment(map, 0, settings);
    adjustment.solve(stop);
    adjustment.apply(map);
    return adjustment.report();
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  FullBundleSettings settings;
};

TEST_F(FullBundle, PutsPosesAndPointsRight) {
  disturb();
  const double before = error();
  ASSERT_GT(before, 0.03);
  const FullBundleReport report = adjust();
  EXPECT_LT(error(), 0.02);
  EXPECT_EQ(report.keyframes, 12);
  EXPECT_GT(report.points, 300);
  EXPECT_GT(report.observations, 2 * report.points);
  EXPECT_LT(report.final.final_cost, report.robust.initial_cost);
  EXPECT_FALSE(report.stopped);
  EXPECT_EQ(map.keyframes().front()->T_cw.translation, SE3{}.translation) << "the oldest is fixed";
  EXPECT_EQ(map.camera().disparity_offset, 0.0);
}

TEST_F(FullBundle, TakesObservationsOutThatDoNotFit) {
  KeyFrame* keyframe = map.keyframes()[6];
  auto pixels = std::make_shared<FeaturePixels>();
  for (int i = 0; i < keyframe->features->size(); ++i)
    pixels->push_back(FeatureView::measured_pixel(*keyframe->features, i));
  std::vector<std::size_t> wrong;
  for (std::size_t i = 0; i < pixels->size() && wrong.size() < 5; ++i) {
    if (keyframe->points[i] == nullptr || keyframe->points[i]->observations.size() < 4) continue;
    (*pixels)[i].v += 40.0F;
    wrong.push_back(i);
  }
  ASSERT_EQ(wrong.size(), 5U);
  keyframe->pixels = pixels;
  const FullBundleReport report = adjust();
  EXPECT_GE(report.removed_observations, 5);
  for (const std::size_t i : wrong) EXPECT_EQ(keyframe->points[i], nullptr) << i;
  EXPECT_LT(error(), 0.02);
}

TEST_F(FullBundle, StoppedBeforeItBeganChangesNothing) {
  disturb();
  const double before = error();
  const std::atomic<bool> stop{true};
  const FullBundleReport report = adjust(&stop);
  EXPECT_TRUE(report.stopped);
  EXPECT_EQ(report.removed_observations, 0);
  EXPECT_LE(error(), before + 1e-9);
}

TEST_F(FullBundle, LeavesOtherSubmapsAlone) {
  disturb();
  KeyFrame* other = map.keyframes()[5];
  other->submap = 1;
  const SE3 T_cw = other->T_cw;
  const FullBundleReport report = adjust();
  EXPECT_EQ(report.keyframes, 11);
  EXPECT_EQ(other->T_cw.translation, T_cw.translation);
}

TEST_F(FullBundle, OfAnEmptyMapDoesNothing) {
  Map empty(world.camera(), world.scales());
  FullBundleAdjustment adjustment(empty, 0, settings);
  adjustment.solve();
  adjustment.apply(empty);
  EXPECT_EQ(adjustment.report().keyframes, 0);
  EXPECT_EQ(adjustment.report().observations, 0);
}

}  // namespace
}  // namespace penumbra::slam
