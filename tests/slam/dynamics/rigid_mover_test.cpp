#include "slam/dynamics/rigid_mover.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "slam/dynamics/movers.h"
#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

// The camera goes 0.8 m ahead; so does a lorry, `lorry` points of it, against `world` points of the street.
struct Scene {
  StereoCamera camera = test::test_camera();
  std::vector<PoseObservation> observations;
  SE3 T_cw;

  Scene(int lorry, int world) {
    T_cw.translation.z() = -0.8;
    const auto draw = [](std::uint64_t axis, int i, double low, double high) {
      return low + (high - low) * static_cast<double>(counter_random(axis, std::uint64_t(i)) % 1000) / 999.0;
    };
    for (int i = 0; i < lorry; ++i) {
      const Eigen::Vector3d p(draw(1, i, -1.2, 1.2), draw(2, i, -1.5, 1.0), draw(3, i, 6.0, 6.2));
      add(p, p);
    }
    for (int i = 0; i < world; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const Eigen::Vector3d p(side * draw(4, i, 3.0, 9.0), draw(5, i, -2.0, 1.5), draw(6, i, 8.0, 30.0));
      add(p, T_cw * p);
    }
  }
  void add(const Eigen::Vector3d& before, const Eigen::Vector3d& now) {
    const Eigen::Vector3d pixel = camera.project_stereo(now);
    if (camera.in_image(pixel.head<2>())) observations.push_back({before, {pixel, 1.0, true}});
  }
  SeparatedMotions separate(const SE3& start, const std::optional<SE3>& predicted = {}) const {
    return separate_motions(camera, observations, optimize_pose(camera, start, observations), predicted, 1,
                            {});
  }
};

TEST(RigidMover, TheWorldWinsAgainstALorryWithMorePoints) {
  const Scene scene(200, 60);
  const PoseEstimate dominant = optimize_pose(scene.camera, SE3{}, scene.observations);
  ASSERT_LT(dominant.T_cw.translation.norm(), 0.1) << "the lorry is dominant";
  const SeparatedMotions motions = scene.separate(SE3{});
  EXPECT_LT((motions.world.T_cw.translation - scene.T_cw.translation).norm(), 0.02);
  ASSERT_TRUE(motions.mover);
  EXPECT_GT(motions.mover->score, 0.9F);
  EXPECT_LT(motions.nearest, 6.0);
  EXPECT_GT(motions.farthest, 6.2);
}

TEST(RigidMover, IsFoundWhereTheWorldIsDominant) {
  const Scene scene(60, 200);
  const SeparatedMotions motions = scene.separate(scene.T_cw);
  EXPECT_LT((motions.world.T_cw.translation - scene.T_cw.translation).norm(), 0.02);
  EXPECT_TRUE(motions.mover);
}

TEST(RigidMover, IsNotFoundWhereNothingMoves) {
  Scene scene(0, 200);
  EXPECT_FALSE(scene.separate(scene.T_cw).mover);
  // Mismatches are no rigid thing.
  for (std::size_t i = 0; i < scene.observations.size(); i += 4) {
    Eigen::Vector3d& pixel = scene.observations[i].measurement.pixel;
    pixel.x() += static_cast<double>(counter_random(8, i) % 80) - 40.0;
    pixel.y() += static_cast<double>(counter_random(9, i) % 60) - 30.0;
  }
  const SeparatedMotions motions = scene.separate(scene.T_cw);
  EXPECT_FALSE(motions.mover);
  EXPECT_LT((motions.world.T_cw.translation - scene.T_cw.translation).norm(), 0.02);
}

TEST(Movers, TellTheWorldAmongPairsAndMarkTheRest) {
  const Scene scene(200, 60);
  const auto features = std::make_shared<FrameFeatures>();
  for (const PoseObservation& seen : scene.observations) {
    const Eigen::Vector3d& pixel = seen.measurement.pixel;
    features->left.keypoints.push_back(
        {.u = static_cast<float>(pixel.x()), .v = static_cast<float>(pixel.y())});
    features->left.descriptors.emplace_back();
    features->u_right.push_back(static_cast<float>(pixel.z()));
    features->depth.push_back(
        static_cast<float>(scene.camera.fx * scene.camera.baseline / (pixel.x() - pixel.z())));
  }
  const PoseEstimate dominant = optimize_pose(scene.camera, SE3{}, scene.observations);
  const PosePairs pairs{scene.camera, scene.observations, dominant};
  for (const bool enabled : {true, false}) {
    Movers movers(scene.camera, level_scales({}), {}, {}, {.enabled = enabled});
    std::vector<char> movable(scene.observations.size(), 0);
    movers.before_pose({1, 0.1, features, {}}, movable);
    const WorldPose world = movers.among_pairs(pairs, &movable);
    EXPECT_EQ(world.mover.has_value(), enabled);
    EXPECT_EQ((world.estimate.T_cw.translation - scene.T_cw.translation).norm() < 0.02, enabled);
    EXPECT_EQ(movers.among_pairs(pairs, nullptr).mover.has_value(), enabled);
    std::ptrdiff_t on_lorry = 0, on_street = 0;
    for (std::size_t i = 0; i < movable.size(); ++i)
      (scene.observations[i].point.z() < 7.0 ? on_lorry : on_street) += movable[i];
    EXPECT_EQ(on_lorry > 150, enabled);
    EXPECT_LT(on_street, 5);
  }
}

TEST(RigidMover, TakesNothingAtAll) {
  const Scene scene(0, 0);
  const SeparatedMotions motions = scene.separate(SE3{});
  EXPECT_FALSE(motions.mover);
  EXPECT_EQ(motions.world.inliers, 0);
}

}  // namespace
}  // namespace penumbra::slam
