// The SLAM with mapping beside the tracker. `./run test` runs them with the thread sanitizer, too.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <future>
#include <string>
#include <thread>

#include "slam/map/map_file.h"
#include "slam/map/ply.h"
#include "slam/pipeline/recorder.h"
#include "slam/pipeline/slam.h"
#include "slam/world/street_sequence.h"
#include "tests/slam/feature_world.h"
#include "tests/slam/recorded_slam.h"

namespace penumbra::slam {
namespace {

// A drive of `frames` frames through the synthetic street; rendered once for all tests.
const std::vector<StereoImages>& drive(int frames, StereoCamera& camera) {
  static std::vector<StereoImages> images;
  synthetic::SequenceSettings settings;
  settings.frames = frames;
  settings.size = {464, 140};
  settings.path = "straight";
  synthetic::StreetSequence street(settings);
  camera = street.camera();
  for (int i = static_cast<int>(images.size()); i < frames; ++i) {
    synthetic::SequenceFrame frame;
    street.render(i, frame);
    images.push_back({i, 0.1 * i, frame.left_grey.clone(), frame.right_grey.clone(), {}});
  }
  return images;
}

constexpr int kFrames = 60;

class SlamThreads : public ::testing::Test {
 protected:
  SlamThreads() : images(drive(kFrames, camera)) { settings.deterministic = false; }
  StereoCamera camera;
  const std::vector<StereoImages>& images;
  SlamSettings settings;
};

TEST_F(SlamThreads, FollowTheStreetAsOneThreadDoes) {
  test::RecordedSlam threaded(camera, Sensor::stereo, settings);
  settings.deterministic = true;
  test::RecordedSlam in_line(camera, Sensor::stereo, settings);
  for (const StereoImages& pair : images) {
    threaded.process(pair);
    in_line.process(pair);
    // Reading is allowed at any time.
    ASSERT_EQ(threaded.trajectory().size(), threaded.results().size());
  }
  threaded.finish();
  in_line.finish();
  EXPECT_EQ(threaded.lost(), 0);
  EXPECT_GT(threaded.map().keyframes().size(), 1U);
  const Trajectory a = threaded.trajectory(), b = in_line.trajectory();
  const double way = b.back().T_wc.translation.norm();
  EXPECT_GT(way, 10.0);
  EXPECT_LT((a.back().T_wc.translation - b.back().T_wc.translation).norm(), 0.01 * way);
}

TEST_F(SlamThreads, LeaveAConsistentMap) {
  test::RecordedSlam slam(camera, Sensor::stereo, settings);
  for (const StereoImages& pair : images) slam.process(pair);
  slam.finish();
  for (const auto& point : slam.map().points()) {
    if (point->erased) continue;
    for (const Observation& o : point->observations) {
      ASSERT_FALSE(o.keyframe->erased);
      ASSERT_EQ(o.keyframe->points[static_cast<std::size_t>(o.feature)], point.get());
    }
  }
}

TEST_F(SlamThreads, CanBeLeftInTheMiddle) {
  test::RecordedSlam slam(camera, Sensor::stereo, settings);
  for (int i = 0; i < 20; ++i) slam.process(images[static_cast<std::size_t>(i)]);
  // The destructor ends the threads, whatever they were doing.
}

TEST_F(SlamThreads, SurviveABlackout) {
  test::RecordedSlam slam(camera, Sensor::stereo, settings);
  for (const StereoImages& pair : images) {
    StereoImages shown = pair;
    if (pair.index >= 25 && pair.index < 30) {
      shown.left = ByteImage::filled(pair.left.width(), pair.left.height(), 0);
      shown.right = shown.left;
    }
    slam.process(shown);
  }
  slam.finish();
  EXPECT_GE(slam.lost(), 5);
  EXPECT_LE(slam.lost(), 15);
  EXPECT_EQ(slam.results().back().tracking.state, TrackingState::tracking);
}

TEST_F(SlamThreads, TakeInstancesWhileTheyTrack) {
  Instance car;
  car.class_name = "car";
  car.score = 1.0F;
  car.region = {180, 50, 90, 50};
  car.mask = ByteImage::filled(90, 50, 255);
  test::RecordedSlam slam(camera, Sensor::stereo, settings,
                          [&](const ImageToSegment&) { return std::vector<Instance>{car}; });
  for (const StereoImages& pair : images) slam.process(pair);
  slam.finish();
  EXPECT_EQ(slam.trajectory().size(), images.size());
  EXPECT_FALSE(slam.instances().empty());
}

// As `penumbra slam --view` does.
TEST_F(SlamThreads, ShowTheMapToWhoLooksOn) {
  test::RecordedSlam slam(camera, Sensor::stereo, settings);
  std::atomic<bool> done{false};
  std::size_t most = 0;
  std::thread watcher([&] {
    while (!done) {
      most = std::max(most, point_cloud_of(slam.map()).vertices.size());
    }
  });
  for (const StereoImages& pair : images) {
    const FrameResult result = slam.process(pair);
    EXPECT_EQ(slam.newest_view().features.size(), static_cast<std::size_t>(result.features));
  }
  slam.finish();
  done = true;
  watcher.join();
  EXPECT_GT(most, 0U);
}

// As `penumbra slam --checkpoint` does: the map is written while the worker goes on.
TEST_F(SlamThreads, WriteTheMapBetweenFrames) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("penumbra_threads_" + std::to_string(getpid()) + ".map");
  test::RecordedSlam slam(camera, Sensor::stereo, settings);
  for (const StereoImages& pair : images) {
    slam.process(pair);
    write_map(file, slam.map());
    EXPECT_LE(read_map(file)->keyframes().size(), images.size());
  }
  slam.finish();
  std::filesystem::remove(file);
}

// The frames so far, too, on a third thread, as one moment's map has them.
TEST_F(SlamThreads, WriteTheFramesWhileTheyTrack) {
  Slam slam(camera, Sensor::stereo, settings);
  Recorder record(slam);
  std::future<std::ptrdiff_t> written;
  for (std::size_t i = 0; i < images.size(); ++i) {
    record.add(slam.process(images[i]));
    if (written.valid()) {
      EXPECT_EQ(written.get(), static_cast<std::ptrdiff_t>(i));
    }
    written = std::async(std::launch::async, [kept = record.kept()] {
      const Trajectory all = kept.trajectory();
      return std::count_if(all.begin(), all.end(), [](const TimedPose& pose) {
        return std::abs(pose.T_wc.rotation.determinant() - 1.0) < 1e-9;
      });
    });
  }
  EXPECT_EQ(written.get(), static_cast<std::ptrdiff_t>(images.size()));
  record.finish();
}

// Seventy frames round a ring: a loop is closed, and the whole map adjusted, while the tracker goes on.
class LoopThreads : public ::testing::Test {
 protected:
  LoopThreads() {
    settings.deterministic = false;
    settings.loops.fewest_frames_apart = 30;
    settings.loops.age = 2;
    settings.loops.consistent = 2;
  }
  static constexpr double kStep = 2.0;  // of 100 a lap: 50 frames are one
  void drive(test::RecordedSlam& slam, int frames) {
    std::vector<int> seen;
    for (int i = 0; i < frames; ++i) {
      // Without images the tracker is many times faster than the mapper: the map must not be left behind.
      slam.process(i, 0.1 * i, world.view(world.T_cw(kStep * i), static_cast<std::uint64_t>(i), seen));
    }
  }
  test::FeatureWorld world;
  SlamSettings settings;
};

TEST_F(LoopThreads, CloseALoopWhileTrackingGoesOn) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 70);
  slam.finish();
  EXPECT_GE(slam.loops().size(), 1U);
  const Trajectory trajectory = slam.trajectory();
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const SE3 truth = world.T_cw(kStep * static_cast<double>(i)).inverse();
    EXPECT_EQ(slam.results()[i].tracking.state, TrackingState::tracking) << i;
    EXPECT_LT((trajectory[i].T_wc.translation - truth.translation).norm(), 0.5) << i;
  }
}

TEST_F(LoopThreads, CanBeLeftWhileTheWholeMapIsAdjusted) {
  test::RecordedSlam slam(world.camera(), Sensor::stereo, settings);
  drive(slam, 68);
}

}  // namespace
}  // namespace penumbra::slam
