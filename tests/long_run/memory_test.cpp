// A run that goes on for a day holds its memory: 500,000 frames, 14 hours at 10 Hz, over a map that is known.
#include <gtest/gtest.h>
#include <malloc.h>

#include "slam/map/map_file.h"
#include "slam/pipeline/slam.h"
#include "tests/slam/feature_world.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

constexpr int kFrames = 500000, kPlaces = 12;

// The features of `view` that show every tenth point of the world: less work for each of so many frames.
std::shared_ptr<const FrameFeatures> thinned(const StereoCamera& camera, const FrameFeatures& view,
                                             const std::vector<int>& seen) {
  auto thin = std::make_shared<FrameFeatures>();
  for (std::size_t i = 0; i < view.left.keypoints.size(); ++i) {
    if (seen[i] % 10 != 0) continue;
    thin->left.keypoints.push_back(view.left.keypoints[i]);
    thin->left.descriptors.push_back(view.left.descriptors[i]);
    thin->u_right.push_back(view.u_right[i]);
    thin->depth.push_back(view.depth[i]);
    thin->colour.push_back(view.colour[i]);
  }
  thin->grid = FeatureGrid(thin->left.keypoints, camera.width, camera.height);
  return thin;
}

// Bytes that the program has asked for and not given back.
std::size_t bytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(Memory, IsHeldOverHalfAMillionFrames) {
  const test::FeatureWorld world;
  const penumbra::test::TemporaryDirectory folder;
  std::vector<std::shared_ptr<const FrameFeatures>> places;
  {
    // There and back along a piece of the road, as often as it takes.
    SlamSettings settings;
    settings.tracker.fewest_initial_points = 20;
    Slam first(world.camera(), Sensor::stereo, settings);
    std::vector<int> seen;
    for (int k = 0; k < kPlaces; ++k) {
      const auto view = world.view(world.T_cw(0.25 * k), static_cast<std::uint64_t>(k), seen);
      places.push_back(thinned(world.camera(), *view, seen));
      first.process(k, 0.1 * k, places.back());
    }
    first.finish();
    write_map(folder / "road.map", first.map());
  }
  SlamSettings settings;
  settings.localise = true;
  settings.tracker.fewest_frame_inliers = settings.tracker.fewest_map_inliers = 12;
  PlaceVerifierSettings& needed = settings.tracker.recognition.anywhere;
  needed = settings.tracker.recognition.last;
  needed.fewest_inliers = needed.fewest_ransac_inliers = 12;
  Slam slam(world.camera(), Sensor::stereo, settings, {}, read_map(folder / "road.map"));
  const std::size_t keyframes = slam.map().keyframes().size();
  std::size_t at_tenth = 0, most = 0;
  int located = 0;
  for (int i = 0; i < kFrames; ++i) {
    const int lap = i % (2 * kPlaces - 2), place = std::min(lap, 2 * kPlaces - 2 - lap);
    // Now and then something is in the way: the frame is lost and found again.
    const bool dark = i % 1000 == 999;
    const FrameResult result =
        slam.process(i, 0.1 * i, dark ? std::make_shared<const FrameFeatures>() : places[std::size_t(place)]);
    located += result.tracking.state == TrackingState::tracking;
    if (i == kFrames / 10) at_tenth = bytes_in_use();
    if (i > kFrames / 10 && i % 997 == 0) most = std::max(most, bytes_in_use());
  }
  slam.finish();
  EXPECT_GE(located, kFrames - kFrames / 1000 - 1);
  EXPECT_EQ(slam.map().keyframes().size(), keyframes);
  EXPECT_LT(most, at_tenth + 100000) << "bytes; a byte a frame would be 450,000";
}

}  // namespace
}  // namespace penumbra::slam
