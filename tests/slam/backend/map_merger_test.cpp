// Maps of several drives through one made-up world.
#include "slam/backend/map_merger.h"

#include <gtest/gtest.h>

#include <set>

#include "nn/base/file.h"
#include "slam/map/map_file.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/recorded_slam.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

class MapMerger : public ::testing::Test {
 protected:
  // The map of the ring road from one place to another, in a world of its own: the first camera's.
  std::filesystem::path drive(const std::string& name, double from, double to) {
    return drive(name, from, to, world);
  }
  std::filesystem::path drive(const std::string& name, double from, double to,
                              const test::FeatureWorld& world) {
    SlamSettings settings;
    settings.deterministic = true;
    test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
    int index = 0;
    for (double steps = from; steps < to; steps += 1.0, ++index)
      slam.process(index, 0.1 * index, world.view(world.T_cw(steps), ++noise, seen));
    slam.finish();
    const std::filesystem::path path = folder / name;
    write_map(path, slam.map());
    return path;
  }
  static std::vector<std::unique_ptr<Map>> read(const std::vector<std::filesystem::path>& files) {
    std::vector<std::unique_ptr<Map>> maps;
    for (const auto& file : files) maps.push_back(read_map(file));
    return maps;
  }
  // Where the first camera of a drive from `steps` on is in the world of one that began at `origin`.
  SE3 truth(double steps, double origin) const { return world.T_cw(origin) * world.T_cw(steps).inverse(); }
  static void expect_whole(const Map& map) {
    std::set<int> ids;
    for (const KeyFrame* keyframe : map.keyframes()) {
      EXPECT_TRUE(ids.insert(keyframe->id).second);
      for (std::size_t f = 0; f < keyframe->points.size(); ++f) {
        const MapPoint* point = keyframe->points[f];
        if (point == nullptr) continue;
        EXPECT_FALSE(point->erased);
        EXPECT_EQ(observing_feature(*point, *keyframe), static_cast<int>(f));
      }
    }
  }

  test::FeatureWorld world;
  penumbra::test::TemporaryDirectory folder;
  std::uint64_t noise = 0;
  std::vector<int> seen;
};

TEST_F(MapMerger, AppendingKeepsEverything) {
  const auto maps = read({drive("a.map", 0.0, 30.0), drive("b.map", 10.0, 30.0)});
  Map into(maps[0]->camera(), maps[0]->scales());
  append_map(into, *maps[0]);
  KeyFrame* first = append_map(into, *maps[1]);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(into.keyframes().size(), maps[0]->keyframes().size() + maps[1]->keyframes().size());
  EXPECT_EQ(into.points().size(), maps[0]->points().size() + maps[1]->points().size());
  EXPECT_NE(first->submap, into.keyframes().front()->submap);
  EXPECT_EQ(first->covisibles.size(), maps[1]->keyframes().front()->covisibles.size());
  expect_whole(into);
}

TEST_F(MapMerger, DrivesThatOverlapBecomeOne) {
  const auto maps = read({drive("a.map", 0.0, 50.0), drive("b.map", 25.0, 65.0)});
  const MergedMaps merged = merge_maps(maps, {});
  EXPECT_EQ(merged.pieces, 1);
  EXPECT_EQ(merged.parts[0].piece, merged.parts[1].piece);
  EXPECT_GT(merged.parts[0].ties + merged.parts[1].ties, 0);
  const SE3 error =
      merged.parts[0].T_merged_own.inverse() * merged.parts[1].T_merged_own * truth(25.0, 0.0).inverse();
  EXPECT_LT(error.translation.norm(), 0.3) << error.translation.transpose();
  EXPECT_LT(error.angle(), 0.01);
  EXPECT_LT(merged.map->points().size(), maps[0]->points().size() + maps[1]->points().size());  // fused
  expect_whole(*merged.map);
}

TEST_F(MapMerger, OneThatOverlapsBothTiesTwoThatDoNot) {
  const auto maps =
      read({drive("a.map", 0.0, 40.0), drive("c.map", 60.0, 100.0), drive("b.map", 20.0, 80.0)});
  const MergedMaps merged = merge_maps(maps, {});
  EXPECT_EQ(merged.pieces, 1);
}

TEST_F(MapMerger, DrivesThatShareNothingStayApart) {
  const auto maps = read({drive("a.map", 0.0, 40.0), drive("b.map", 0.0, 40.0, test::FeatureWorld(2))});
  const MergedMaps merged = merge_maps(maps, {});
  EXPECT_EQ(merged.pieces, 2);
  for (const MergedPart& part : merged.parts) {
    EXPECT_EQ(part.ties, 0);
    EXPECT_LT(part.T_merged_own.translation.norm(), 1e-9);
  }
}

TEST_F(MapMerger, TheOrderOfTheMapsChangesNothing) {
  const std::filesystem::path a = drive("a.map", 0.0, 50.0), b = drive("b.map", 25.0, 65.0),
                              c = drive("c.map", 100.0, 120.0);
  const auto bytes = [&](const std::vector<std::filesystem::path>& files) {
    write_map(folder / "merged.map", *merge_maps(read(files), {}).map);
    return nn::read_file(folder / "merged.map", "a map");
  };
  const std::string once = bytes({a, b, c});
  EXPECT_EQ(bytes({c, a, b}), once);
  EXPECT_EQ(bytes({b, c, a}), once);
}

TEST_F(MapMerger, EmptyMapsAddNothing) {
  auto maps = read({drive("a.map", 0.0, 30.0)});
  maps.push_back(std::make_unique<Map>(maps[0]->camera(), maps[0]->scales()));
  const MergedMaps merged = merge_maps(maps, {});
  EXPECT_EQ(merged.map->keyframes().size(), maps[0]->keyframes().size());
  EXPECT_EQ(merged.parts[1].keyframes, 0);
}

}  // namespace
}  // namespace penumbra::slam
