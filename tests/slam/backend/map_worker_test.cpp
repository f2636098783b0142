#include "slam/backend/map_worker.h"

#include <gtest/gtest.h>

#include "tests/slam/backend/mapped_drive.h"

namespace penumbra::slam {
namespace {

class MapWorkerTest : public ::testing::TestWithParam<bool> {
 protected:
  KeyFrame* submit(MapWork work) {
    KeyFrame* keyframe = work.keyframe.get();
    worker.submit(std::move(work));
    const std::unique_lock lock(map.mutex());
    if (keyframe != nullptr) drive.learn(*keyframe);
    return keyframe;
  }
  void add(int keyframes) {
    for (int k = 0; k < keyframes; ++k) {
      MapWork work;
      {
        const std::unique_lock lock(map.mutex());  // the drive reads what points have become
        work = drive.next(added++);
      }
      submit(std::move(work));
    }
  }

  test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  PlaceIndex index;
  LocalMapper mapper{map, {}};
  LoopCloser loop_closer{map, index, {}};
  test::MappedDrive drive{world, map};
  MapWorker worker{map, mapper, loop_closer, {}, GetParam()};
  int added = 0;
};

TEST_P(MapWorkerTest, HasTheKeyframeInTheMapOnReturn) {
  for (int k = 0; k < 5; ++k) {
    add(1);
    const std::shared_lock lock(map.mutex());
    ASSERT_EQ(map.keyframes().size(), static_cast<std::size_t>(k + 1));
    EXPECT_GT(test::count_points(*map.keyframes().back()), 100);
  }
  worker.finish();
  EXPECT_EQ(map.keyframes().size(), 5U);
}

TEST_P(MapWorkerTest, AdjustsTheWholeMapWhenItHasDoubled) {
  add(20);
  worker.finish();
  const StageTimer times = worker.take_times();
  EXPECT_EQ(times.stages().at("mapping").count(), 20U);
  EXPECT_EQ(times.stages().at("loops").count(), 20U);
  EXPECT_EQ(times.stages().at("keyframe_insertion").count(), 20U);
  if (!GetParam()) {
    EXPECT_EQ(times.stages().at("full_bundle").count(), 1U);
  }
  EXPECT_TRUE(worker.take_times().stages().empty()) << "told once";
  for (const KeyFrame* keyframe : map.keyframes()) {
    const SE3 truth = world.T_cw(keyframe->frame_index);
    EXPECT_LT((keyframe->T_cw * truth.inverse()).translation.norm(), 0.05);
  }
}

TEST_P(MapWorkerTest, TakesOutWhatTurnsOutToMove) {
  add(3);
  worker.finish();
  KeyFrame* keyframe = map.keyframes().back();
  MapPoint* point = keyframe->points[4];
  ASSERT_NE(point, nullptr);
  MapWork work;
  work.edits.moving.push_back({keyframe, {4, 5}});
  work.edits.objects.push_back({keyframe, {{7, "car", {1.0, 0.0, 9.0}, {}, true}}});
  submit(std::move(work));
  worker.finish();
  EXPECT_TRUE(keyframe->view().is_movable(4));
  EXPECT_TRUE(keyframe->view().is_movable(5));
  EXPECT_FALSE(keyframe->view().is_movable(6));
  EXPECT_EQ(keyframe->points[4], nullptr);
  ASSERT_EQ(keyframe->objects.size(), 1U);
  EXPECT_EQ(keyframe->objects[0].number, 7);
  // What is told of a keyframe that has gone meanwhile is not kept.
  map.erase_keyframe(keyframe);
  MapWork late;
  late.edits.objects.push_back({keyframe, {{7, "car", {1.0, 0.0, 9.0}, {}, true}}});
  submit(std::move(late));
  worker.finish();
  EXPECT_TRUE(keyframe->objects.empty());
}

// Since a keyframe was located its reference has been moved: it follows.
TEST_P(MapWorkerTest, MovesAKeyframeAlongWithItsReference) {
  add(2);
  worker.finish();
  MapWork work = drive.next(added++);
  KeyFrame* reference = map.keyframes().back();
  work.reference = reference;
  work.reference_T_cw = reference->T_cw;
  const SE3 from_reference = work.keyframe->T_cw * reference->T_cw.inverse();
  Vector6d motion = Vector6d::Zero();
  motion[0] = 0.5;
  SE3 T_wr = reference->T_cw.inverse();
  T_wr = SE3::exp(motion) * T_wr;
  for (KeyFrame* keyframe : map.keyframes()) keyframe->T_cw = keyframe->T_cw * SE3::exp(motion).inverse();
  for (const auto& point : map.points()) point->position = SE3::exp(motion) * point->position;
  const KeyFrame* keyframe = submit(std::move(work));
  worker.finish();
  const SE3 now = keyframe->T_cw * reference->T_cw.inverse();
  EXPECT_LT((now.translation - from_reference.translation).norm(), 0.05);
  EXPECT_LT((reference->T_cw.inverse().translation - T_wr.translation).norm(), 0.05);
}

TEST_P(MapWorkerTest, EndsWithWorkThatIsStillWaiting) { add(4); }

TEST_P(MapWorkerTest, WithoutWorkIsFinishedAtOnce) {
  worker.finish();
  worker.submit({});
  worker.finish();
  EXPECT_TRUE(map.keyframes().empty());
}

INSTANTIATE_TEST_SUITE_P(InLineAndThreaded, MapWorkerTest, ::testing::Bool());

}  // namespace
}  // namespace penumbra::slam
