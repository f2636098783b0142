#include "slam/map/map.h"

#include <gtest/gtest.h>

#include <fstream>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"
#include "slam/map/ply.h"
#include "slam/map/projection.h"
#include "tests/slam/world/synthetic.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

std::shared_ptr<const FrameFeatures> features(int count, bool stereo) {
  auto f = std::make_shared<FrameFeatures>();
  const std::size_t n = static_cast<std::size_t>(count);
  for (int i = 0; i < count; ++i) {
    f->left.keypoints.push_back({100.0F + static_cast<float>(i), 100.0F, 0, 0.0F, 1.0F});
    f->left.descriptors.push_back({counter_random(1, static_cast<std::uint64_t>(i)), 0, 0, 0});
  }
  f->u_right.assign(n, stereo ? 50.0F : -1.0F);
  f->depth.assign(n, stereo ? 7.0F : -1.0F);
  f->colour.assign(n, {1, 2, 3});
  f->grid = FeatureGrid(f->left.keypoints, 1241, 376);
  return f;
}

// Three keyframes that see the same forty points.
class MapOfThree : public ::testing::Test {
 protected:
  MapOfThree() {
    for (int k = 0; k < 3; ++k) {
      SE3 T_cw;
      T_cw.translation.z() = -0.5 * k;
      keyframes.push_back(map.add_keyframe(10 * k, k, T_cw, features(50, true)));
    }
    for (int i = 0; i < 40; ++i) {
      MapPoint* point = map.add_point({0.1 * i, 0.0, 10.0}, keyframes[0], i);
      map.add_observation(point, keyframes[1], i);
      map.add_observation(point, keyframes[2], i);
      map.update_point(point);
      points.push_back(point);
    }
    for (KeyFrame* k : keyframes) map.update_covisibility(k);
  }
  // Both directions of every observation agree, and nothing erased is referred to.
  void expect_consistent() const {
    for (const auto& point : map.points()) {
      if (point->erased) {
        EXPECT_TRUE(point->observations.empty());
      }
      for (const Observation& o : point->observations) {
        EXPECT_FALSE(o.keyframe->erased);
        EXPECT_EQ(o.keyframe->points[std::size_t(o.feature)], point.get());
      }
    }
    for (const KeyFrame* k : map.keyframes()) {
      for (std::size_t i = 0; i < k->points.size(); ++i) {
        if (k->points[i] != nullptr) {
          EXPECT_EQ(observing_feature(*k->points[i], *k), static_cast<int>(i));
        }
      }
      for (const Covisible& c : k->covisibles) EXPECT_FALSE(c.keyframe->erased);
    }
  }

  Map map{test::test_camera(), {1.0, 1.2, 1.44}};
  std::vector<KeyFrame*> keyframes;
  std::vector<MapPoint*> points;
};

TEST_F(MapOfThree, KnowsWhoSeesWhat) {
  expect_consistent();
  EXPECT_EQ(points[3]->observations.size(), 3U);
  ASSERT_EQ(keyframes[0]->covisibles.size(), 2U);
  EXPECT_EQ(keyframes[0]->covisibles[0].shared_points, 40);
  EXPECT_EQ(keyframes[0]->covisibles[0].keyframe, keyframes[1]);
}

TEST_F(MapOfThree, AnObservationIsAddedOnlyOnce) {
  map.add_observation(points[0], keyframes[0], 45);  // the keyframe sees it already
  map.add_observation(points[1], keyframes[1], 2);   // the feature shows another point
  EXPECT_EQ(points[0]->observations.size(), 3U);
  expect_consistent();
}

TEST_F(MapOfThree, ErasingAPointLeavesNoTrace) {
  map.erase_point(points[5]);
  map.erase_point(points[5]);
  expect_consistent();
  EXPECT_EQ(keyframes[1]->points[5], nullptr);
  const std::size_t before = map.points().size();
  map.collect_erased();
  EXPECT_EQ(map.points().size(), before - 1);
}

TEST_F(MapOfThree, MergingMovesTheObservations) {
  MapPoint* twin = map.add_point({0.7, 0.0, 10.0}, keyframes[0], 47);
  map.merge_points(twin, points[7]);
  EXPECT_TRUE(twin->erased);
  EXPECT_EQ(twin->replacement, points[7]);
  expect_consistent();
  // points[7] was seen by that keyframe already, so its second feature is free again.
  EXPECT_EQ(keyframes[0]->points[47], nullptr);
  map.merge_points(points[7], points[7]);
  EXPECT_FALSE(points[7]->erased);
}

TEST_F(MapOfThree, AnErasedKeyframeKeepsItsPlaceThroughItsStandIn) {
  const SE3 before = current_pose(*keyframes[1]);
  keyframes[1]->objects.resize(3);
  map.erase_keyframe(keyframes[1]);
  expect_consistent();
  EXPECT_TRUE(keyframes[1]->objects.empty()) << "nobody asks for them any more";
  EXPECT_EQ(map.keyframes().size(), 2U);
  EXPECT_LT((current_pose(*keyframes[1]) * before.inverse()).log().norm(), 1e-12);
  // It moves with the keyframe that stands in for it.
  const SE3 moved = test::random_motion(1, 1.0, 0.1);
  keyframes[1]->stand_in->T_cw = keyframes[1]->stand_in->T_cw * moved;
  EXPECT_LT((current_pose(*keyframes[1]) * (before * moved).inverse()).log().norm(), 1e-12);
}

TEST_F(MapOfThree, TheFirstKeyframeIsNeverErased) {
  map.erase_keyframe(keyframes[0]);
  EXPECT_FALSE(keyframes[0]->erased);
  map.erase_keyframe(keyframes[2]);
  map.erase_keyframe(keyframes[1]);
  EXPECT_EQ(map.keyframes().size(), 1U);
  expect_consistent();
}

TEST_F(MapOfThree, PointsWithoutEnoughViewsGo) {
  map.remove_observation(points[0], keyframes[0]);
  map.remove_observation(points[0], keyframes[1]);
  EXPECT_FALSE(points[0]->erased) << "one view with stereo depth is enough";
  map.remove_observation(points[0], keyframes[2]);
  EXPECT_TRUE(points[0]->erased);
  expect_consistent();
}

TEST_F(MapOfThree, ProjectsOnlyWhatCanBeSeen) {
  const StereoCamera camera = test::test_camera();
  const auto projection = project_point(camera, SE3{}, *points[0], map.scales());
  ASSERT_TRUE(projection.has_value());
  EXPECT_NEAR(projection->u, camera.cx, 1e-3);
  EXPECT_EQ(projection->level, 0);
  SE3 turned;
  turned.rotation = so3_exp({0.0, 3.0, 0.0});
  EXPECT_FALSE(project_point(camera, turned, *points[0], map.scales()).has_value());
  SE3 far;
  far.translation.z() = 500.0;
  EXPECT_FALSE(project_point(camera, far, *points[0], map.scales()).has_value());
}

TEST_F(MapOfThree, IsWrittenAsPly) {
  map.erase_point(points[0]);
  const penumbra::test::TemporaryDirectory folder;
  write_ply(folder / "map.ply", point_cloud_of(map));
  std::ifstream file(folder / "map.ply", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(bytes.find("element vertex 42\n"), std::string::npos);  // 39 points, 3 keyframes
  const std::size_t header = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes.size() - header, 42U * 15U);
  EXPECT_THROW(write_ply(folder / "missing/map.ply", {}), Error);
}

}  // namespace
}  // namespace penumbra::slam
