// Stereo pairs whose disparities are all wrong by the same amount: whole runs through a made-up world,
// without images.
#include <gtest/gtest.h>

#include <cmath>

#include "slam/map/map_file.h"
#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/recorded_slam.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

// A drive along the ring road. The rig has a disparity offset of which the camera that is given knows
// nothing.
class SelfCalibration : public ::testing::Test {
 protected:
  void drive(test::RecordedSlam& slam, double offset, double to) {
    for (double steps = 0.0; steps < to; steps += 1.0) {
      const SE3 T_cw = world.T_cw(steps);
      const int index = static_cast<int>(slam.results().size());
      const std::shared_ptr<FrameFeatures> view = world.view(T_cw, static_cast<std::uint64_t>(index), seen);
      for (std::size_t i = 0; i < view->u_right.size(); ++i) {
        if (view->u_right[i] < 0.0F) continue;
        view->u_right[i] -= static_cast<float>(offset);
        const double disparity = view->left.keypoints[i].u - view->u_right[i];
        view->depth[i] = static_cast<float>(slam.map().camera().depth_from_disparity(disparity));
        if (view->u_right[i] < 0.0F || !(view->depth[i] > 0.0F)) view->u_right[i] = view->depth[i] = -1.0F;
      }
      truth.push_back({0.1 * index, T_cw.inverse()});
      slam.process(index, 0.1 * index, view);
    }
    slam.finish();
  }
  // Root mean square over the frames, metres.
  double error(const test::RecordedSlam& slam) const {
    double sum = 0.0;
    const Trajectory found = slam.trajectory();
    for (std::size_t i = 0; i < found.size(); ++i) {
      sum += (found[i].T_wc.translation - truth[i].T_wc.translation).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(found.size()));
  }

  test::FeatureWorld world;
  SlamSettings settings;
  Trajectory truth;
  std::vector<int> seen;
};

TEST_F(SelfCalibration, FindsTheOffsetAndMendsTheWay) {
  for (const double offset : {-0.3, 0.3}) {
    truth.clear();
    test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
    drive(slam, offset, 60.0);
    EXPECT_NEAR(slam.map().camera().disparity_offset, offset, 0.1);
    const double with = error(slam);

    truth.clear();
    SlamSettings off = settings;
    off.full_bundle.disparity_offset_sigma = 0.0;
    test::RecordedSlam exact(world.camera(), Sensor::stereo, off);
    drive(exact, offset, 60.0);
    EXPECT_EQ(exact.map().camera().disparity_offset, 0.0);
    EXPECT_LT(with, 0.7 * error(exact)) << offset;
  }
}

TEST_F(SelfCalibration, FindsNoneWhereThereIsNone) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.0, 60.0);
  EXPECT_NEAR(slam.map().camera().disparity_offset, 0.0, 0.1);
}

TEST_F(SelfCalibration, GoesOnFromTheOffsetOfALoadedMap) {
  const penumbra::test::TemporaryDirectory folder;
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 0.5, 60.0);
  write_map(folder / "ring.map", slam.map());
  settings.localise = true;
  truth.clear();
  test::RecordedSlam again(world.camera(), Sensor::stereo, settings, {}, read_map(folder / "ring.map"));
  EXPECT_EQ(again.map().camera().disparity_offset, slam.map().camera().disparity_offset);
  drive(again, 0.5, 30.0);
  EXPECT_EQ(again.lost(), 0);
  EXPECT_LT(error(again), 0.2);
}

}  // namespace
}  // namespace penumbra::slam
