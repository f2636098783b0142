// A map of a piece of the ring road (tests/slam/feature_world.h), a last frame that was located in it and one
// that is to be: what the ways to locate a frame are tested with.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "slam/frontend/locating/hypothesis.h"
#include "slam/frontend/locating/local_map_search.h"
#include "slam/frontend/locating/locating_input.h"
#include "tests/slam/feature_world.h"

namespace penumbra::test {

class LocatingScene : public ::testing::Test {
 protected:
  static constexpr int kKeyframes = 20;

  LocatingScene() {
    for (int k = 0; k < kKeyframes; ++k) drive.add_keyframe(k);
    index.insert_all(map);
    remember(10.0);
  }

  // What a camera sees at `T_cw`.
  slam::Frame frame_at(const slam::SE3& T_cw) {
    std::vector<int> seen;
    slam::Frame frame;
    frame.index = ++frames;
    frame.timestamp = 0.1 * frames;
    frame.features = world.view(T_cw, static_cast<std::uint64_t>(500 + frames), seen);
    frame.movable.assign(seen.size(), 0);
    frame.pyramid = &pyramid;
    return frame;
  }
  // The last frame was located there, among the map's points.
  void remember(double steps) {
    slam::Frame frame = frame_at(world.T_cw(steps));
    slam::Hypothesis there;
    there.begin(frame, map.keyframes()[static_cast<std::size_t>(steps)]);
    there.T_cw = world.T_cw(steps);
    slam::LocatingInput in = input(frame, there.T_cw);
    slam::search_local_map(in, std::nullopt, there);
    ASSERT_TRUE(there.success);
    frame.T_cw = there.T_cw;
    frame.points = there.points;
    last.remember(frame);
    last_inliers = there.inliers;
    reference = there.reference;
  }
  // `frame` is expected at `predicted`, by a motion that was measured.
  slam::LocatingInput input(const slam::Frame& frame, const slam::SE3& predicted) {
    slam::LocatingInput in{frame, last, map, index, settings, timer, predicted};
    in.motion_known = true;
    in.last_pairs = in.last_inliers = last_inliers;
    in.reference = reference;
    return in;
  }
  // Metres between where the hypothesis has the camera and where it was.
  static double error(const slam::Hypothesis& found, const slam::SE3& truth) {
    return (found.T_cw.inverse().translation - truth.inverse().translation).norm();
  }

  FeatureWorld world;
  slam::Map map{world.camera(), world.scales()};
  DriftingDrive drive{world, map, slam::Vector6d::Zero()};
  slam::PlaceIndex index;
  slam::LastFrame last{map};
  slam::ImagePyramid pyramid;  // without images: no patches
  slam::TrackerSettings settings;
  StageTimer timer;
  slam::KeyFrame* reference = nullptr;
  int frames = 0, last_inliers = 0;
  slam::Hypothesis found, spare;
};

}  // namespace penumbra::test
