#include "slam/evaluation/dense_evaluation.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"

namespace penumbra::slam {
namespace {

constexpr int kWallWidth = 120, kWallHeight = 90;
const StereoCamera kWallCamera = {.fx = 100.0,
                                  .fy = 100.0,
                                  .cx = 60.0,
                                  .cy = 45.0,
                                  .baseline = 0.08,
                                  .width = kWallWidth,
                                  .height = kWallHeight};

// A wall 3 m ahead, and somebody 1.5 m ahead in the left third.
struct WallScene {
  FloatImage depth = FloatImage::filled(kWallWidth, kWallHeight, 3.0F);
  ByteImage moves = ByteImage::filled(kWallWidth, kWallHeight, 0);
  WallScene() {
    for (int v = 0; v < kWallHeight; ++v) {
      for (int u = 0; u < kWallWidth / 3; ++u) {
        depth.at(u, v) = 1.5F;
        moves.at(u, v) = DenseTruth::kPerson;
      }
    }
  }
};

DenseCloud cloud_of(const WallScene& scene, bool person, float off) {
  DenseCloud cloud;
  for (int v = 0; v < kWallHeight; v += 2) {
    for (int u = 0; u < kWallWidth; u += 2) {
      if (scene.moves.at(u, v) != 0 && !person) continue;
      const Eigen::Vector3f p = kWallCamera.back_project(u, v, scene.depth.at(u, v) + off).cast<float>();
      cloud.places.push_back({p.x(), p.y(), p.z()});
    }
  }
  return cloud;
}

TEST(DenseEvaluation, FindsNothingWrongWithTheTruth) {
  const WallScene scene;
  DenseTruth truth;
  truth.add(kWallCamera, {}, scene.depth, scene.moves, scene.depth, 5.0);
  const DenseScore score = truth.score(cloud_of(scene, false, 0.0F), {});
  EXPECT_LT(score.median_error, 1e-6);
  EXPECT_EQ(score.completeness, 1.0);
  EXPECT_EQ(score.ghosts, 0.0);
}

TEST(DenseEvaluation, MeasuresErrorsGapsAndGhosts) {
  const WallScene scene;
  DenseTruth truth;
  truth.add(kWallCamera, {}, scene.depth, scene.moves, scene.depth, 5.0);
  const DenseScore off = truth.score(cloud_of(scene, false, 0.02F), {});
  EXPECT_NEAR(off.median_error, 0.02, 0.002);
  EXPECT_NEAR(off.median_error_at_3m, 0.02, 0.002);
  const DenseScore with_person = truth.score(cloud_of(scene, true, 0.0F), {});
  EXPECT_NEAR(with_person.ghosts, 1.0 / 3.0, 0.01);
  EXPECT_EQ(with_person.people, with_person.ghosts);
  DenseCloud half = cloud_of(scene, false, 0.0F);
  half.places.resize(half.places.size() / 2);
  EXPECT_NEAR(truth.score(half, {}).completeness, 0.5, 0.05);
  EXPECT_EQ(truth.score({}, {}).completeness, 0.0);
  EXPECT_EQ(DenseTruth().score(half, {}).completeness, 0.0);
}

TEST(DenseEvaluation, TellsPeopleFromThings) {
  WallScene scene;
  for (int v = 0; v < kWallHeight / 2; ++v) {
    for (int u = 0; u < kWallWidth / 3; ++u) scene.moves.at(u, v) = DenseTruth::kThingMoves;
  }
  DenseTruth truth;
  truth.add(kWallCamera, {}, scene.depth, scene.moves, scene.depth, 5.0);
  const DenseScore score = truth.score(cloud_of(scene, true, 0.0F), {});
  EXPECT_NEAR(score.ghosts, 1.0 / 3.0, 0.01);
  EXPECT_NEAR(score.people, 1.0 / 6.0, 0.01);
}

TEST(DenseEvaluation, CountsOnlyWhatTheSensorMeasured) {
  const WallScene scene;
  FloatImage sensed = scene.depth.clone();
  for (int v = kWallHeight / 2; v < kWallHeight; ++v) std::fill_n(sensed.row(v), kWallWidth, 0.0F);
  DenseTruth truth;
  truth.add(kWallCamera, {}, scene.depth, scene.moves, sensed, 5.0);
  DenseCloud upper = cloud_of(scene, false, 0.0F);
  std::erase_if(upper.places, [](const std::array<float, 3>& p) { return p[1] >= 0.0F; });
  EXPECT_NEAR(truth.score(upper, {}).completeness, 1.0, 0.03);
}

TEST(DenseEvaluation, AlignsByOrientationsWhereNothingMoves) {
  SE3 moved;
  moved.rotation = so3_exp({0.3, -0.8, 0.2});
  moved.translation = {1.0, 2.0, -3.0};
  Trajectory truth, estimate;
  for (int i = 0; i < 4; ++i) {
    SE3 T;
    T.rotation = so3_exp({0.1 * i, 0.0, 0.05 * i});
    estimate.push_back({0.1 * i, T});
    truth.push_back({0.1 * i, moved * T});
  }
  const Similarity found = align_poses(truth, estimate);
  EXPECT_NEAR((found.rotation - moved.rotation).norm(), 0.0, 1e-12);
  EXPECT_NEAR((found.translation - moved.translation).norm(), 0.0, 1e-12);
  EXPECT_THROW(align_poses({}, {}), InputError);
}

}  // namespace
}  // namespace penumbra::slam
