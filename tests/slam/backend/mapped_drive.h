// Keyframes along the ring road (tests/slam/feature_world.h) as a tracker without errors would hand them to
// the mapper: what each shows of the points that the map has is known.
#pragma once

#include <memory>
#include <vector>

#include "slam/backend/map_worker.h"
#include "tests/slam/feature_world.h"

namespace penumbra::test {

class MappedDrive {
 public:
  MappedDrive(const FeatureWorld& world, slam::Map& map) : world_(world), map_(map) {}

  // The keyframe at `steps`, which is not in the map yet, with the points that it shows.
  slam::MapWork next(double steps) {
    slam::MapWork work;
    const auto features = world_.view(world_.T_cw(steps), static_cast<std::uint64_t>(3000 + frames_), seen_);
    work.keyframe = map_.new_keyframe(frames_, 0.1 * frames_, world_.T_cw(steps), features);
    ++frames_;
    for (const int w : seen_) work.tracked.push_back(slam::present(point_of(w)));
    work.aligned.assign(work.tracked.size(), 0);
    return work;
  }
  // To be called when it is in the map: from here on its points are known.
  void learn(const slam::KeyFrame& keyframe) {
    for (std::size_t i = 0; i < seen_.size(); ++i) point_of(seen_[i]) = keyframe.points[i];
  }
  // The world's points that the newest keyframe shows, per feature.
  const std::vector<int>& seen() const { return seen_; }

 private:
  slam::MapPoint*& point_of(int w) {
    const auto at = static_cast<std::size_t>(w);
    if (points_.size() <= at) points_.resize(at + 1, nullptr);
    return points_[at];
  }

  const FeatureWorld& world_;
  slam::Map& map_;
  int frames_ = 0;
  std::vector<int> seen_;
  std::vector<slam::MapPoint*> points_;  // of the world's
};

inline int count_points(const slam::KeyFrame& keyframe) {
  return static_cast<int>(keyframe.points.size()) -
         static_cast<int>(std::count(keyframe.points.begin(), keyframe.points.end(), nullptr));
}

inline int count_points(const slam::Map& map) {
  return static_cast<int>(std::count_if(map.points().begin(), map.points().end(),
                                        [](const auto& point) { return !point->erased; }));
}

}  // namespace penumbra::test
