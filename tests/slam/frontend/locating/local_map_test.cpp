#include "slam/frontend/locating/local_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "slam/map/map.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// The definition, word for word.
LocalMap naive_local_map(const std::vector<MapPoint*>& shown, KeyFrame* old_reference, std::size_t most) {
  std::map<int, Covisible> votes;
  for (const MapPoint* point : shown) {
    if (point == nullptr) continue;
    for (const Observation& o : point->observations) {
      votes[o.keyframe->id].keyframe = o.keyframe;
      ++votes[o.keyframe->id].shared_points;
    }
  }
  std::vector<Covisible> ordered;
  for (const auto& [id, vote] : votes) ordered.push_back(vote);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Covisible& a, const Covisible& b) { return a.shared_points > b.shared_points; });
  std::vector<KeyFrame*> keyframes;
  for (const Covisible& vote : ordered) keyframes.push_back(vote.keyframe);
  LocalMap local;
  local.reference = keyframes.empty() ? old_reference : keyframes.front();
  if (local.reference != nullptr) {
    const auto add = [&](KeyFrame* k) {
      if (std::count(keyframes.begin(), keyframes.end(), k) == 0) keyframes.push_back(k);
    };
    add(local.reference);
    for (const Covisible& c : local.reference->covisibles) add(c.keyframe);
  }
  if (keyframes.size() > most) keyframes.resize(most);
  const auto by_id = [](const MapPoint* a, const MapPoint* b) { return a->id < b->id; };
  std::set<MapPoint*, decltype(by_id)> points(by_id);
  for (const KeyFrame* keyframe : keyframes) {
    for (MapPoint* point : keyframe->points) {
      if (point != nullptr) points.insert(point);
    }
  }
  local.points.assign(points.begin(), points.end());
  return local;
}

TEST(LocalMap, IsThatOfTheDefinition) {
  const test::FeatureWorld world;
  Map map{world.camera(), world.scales()};
  test::DriftingDrive drive(world, map, Vector6d::Zero());
  for (int k = 0; k < 40; ++k) drive.add_keyframe(k);
  LocalMapCollector collector;
  for (KeyFrame* keyframe : map.keyframes()) {
    for (const int most : {0, 1, 5, 100}) {
      for (const bool empty : {false, true}) {
        const std::vector<MapPoint*> shown = empty ? std::vector<MapPoint*>(10, nullptr) : keyframe->points;
        KeyFrame* old = keyframe->id % 2 == 0 ? map.keyframes().front() : nullptr;
        const LocalMap naive = naive_local_map(shown, old, static_cast<std::size_t>(most));
        const LocalMap& local = collector.collect(shown, old, most);
        EXPECT_EQ(local.reference, naive.reference);
        EXPECT_EQ(local.points, naive.points);
      }
    }
  }
}

}  // namespace
}  // namespace penumbra::slam
