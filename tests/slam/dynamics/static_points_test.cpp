#include "slam/dynamics/static_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

constexpr double kFrameSeconds = 1.0 / 30.0;
constexpr int kPersonPoints = 100, kWallPoints = 200;

double drawn(std::uint64_t stream, std::uint64_t n) { return 2.0 * counter_uniform(stream, n) - 1.0; }

// A person of points 2 m away before a wall, seen by a camera that drifts to the right.
class StaticPointsRoom {
 public:
  StaticPointsRoom() : camera_{525.0, 525.0, 319.5, 239.5, 0.08, 640, 480} {}

  const StereoCamera& camera() const { return camera_; }
  SE3 T_cw(int frame) const {
    Vector6d pose = Vector6d::Zero();
    pose[0] = -0.01 * frame;
    pose[4] = 0.001 * frame;
    return SE3::exp(pose);
  }
  SE3 T_step(int frame) const { return frame == 0 ? SE3{} : T_cw(frame) * T_cw(frame - 1).inverse(); }

  // `displacement`: of the person since the start, metres. The person's features come first.
  std::shared_ptr<const FrameFeatures> features(int frame, const Eigen::Vector3d& displacement) const {
    auto features = std::make_shared<FrameFeatures>();
    for (int i = 0; i < kPersonPoints + kWallPoints; ++i) {
      const auto n = static_cast<std::uint64_t>(i);
      Eigen::Vector3d p(2.0 * drawn(1, n), 1.5 * drawn(2, n), 4.0);
      if (i < kPersonPoints)
        p = Eigen::Vector3d(0.3 * drawn(1, n), 0.6 * drawn(2, n), 2.0 + 0.1 * drawn(3, n)) + displacement;
      const Eigen::Vector3d q = T_cw(frame) * p, pixel = camera_.project_stereo(q);
      const auto noise = [&](std::uint64_t axis) {
        return 0.4 * drawn(100 + axis, n + 1000 * static_cast<std::uint64_t>(frame));
      };
      const float u = static_cast<float>(pixel.x() + noise(0)), v = static_cast<float>(pixel.y() + noise(1));
      features->left.keypoints.push_back({u, v, 0, 0.0F, 1.0F});
      Descriptor descriptor{};
      for (std::size_t w = 0; w < descriptor.size(); ++w) descriptor[w] = counter_random(7 + w, n);
      features->left.descriptors.push_back(descriptor);
      features->depth.push_back(static_cast<float>(q.z() * (1.0 + 0.003 * noise(2))));
      features->u_right.push_back(static_cast<float>(pixel.z()));
    }
    features->grid = FeatureGrid(features->left.keypoints, camera_.width, camera_.height);
    return features;
  }

 private:
  StereoCamera camera_;
};

// A run in which all of the person is left out by its class before each pose.
class StaticPointsRun {
 public:
  explicit StaticPointsRun(StaticPointMode mode)
      : static_points_(room_.camera(), {1.0}, settings_of(mode), history_) {}

  // Returns the features of the next frame that are given back.
  int next(const Eigen::Vector3d& displacement) {
    const auto features = room_.features(frame_, displacement);
    std::vector<char> movable(static_cast<std::size_t>(features->size()), 0);
    std::fill_n(movable.begin(), kPersonPoints, char{1});
    const SE3 T_step = room_.T_step(frame_);
    history_.begin(frame_, frame_ * kFrameSeconds, features, T_step);
    static_points_.before_pose({frame_, frame_ * kFrameSeconds, features, T_step}, movable);
    FeaturePixels pixels;
    for (int i = 0; i < features->size(); ++i) pixels.push_back(FeatureView::measured_pixel(*features, i));
    const bool any = static_points_.between_poses({T_step, &pixels}, movable);
    const auto marked = static_cast<int>(std::count(movable.begin(), movable.end(), 1));
    EXPECT_EQ(any, marked < kPersonPoints);
    EXPECT_EQ(static_points_.count().given_back, kPersonPoints - marked);
    EXPECT_EQ(static_points_.count().left_out, kPersonPoints);
    history_.locate(T_step, true, nullptr, movable);
    static_points_.after_pose({T_step, true, nullptr, {}}, movable);
    ++frame_;
    return kPersonPoints - marked;
  }

 private:
  static StaticPointSettings settings_of(StaticPointMode mode) {
    StaticPointSettings settings;
    settings.constraint.mode = mode;
    return settings;
  }
  StaticPointsRoom room_;
  FrameHistory history_{60};
  StaticPoints static_points_;
  int frame_ = 0;
};

TEST(StaticPoints, GivesBackWhoSitsAndKeepsOutWhoWalks) {
  for (const StaticPointMode mode : {StaticPointMode::paper, StaticPointMode::adaptive}) {
    StaticPointsRun sits(mode), walks(mode), comes(mode);
    for (int frame = 0; frame < 40; ++frame) {
      const int back = sits.next(Eigen::Vector3d::Zero());
      if (frame < 9) {
        EXPECT_EQ(back, 0) << "no view is a third of a second old";
      } else if (frame > 10) {
        EXPECT_GE(back, 85) << "frame " << frame;
      }
      EXPECT_EQ(walks.next({0.03 * frame, 0.0, 0.0}), 0) << "frame " << frame;
      // Towards the camera, along its axis, at 1.2 m a second: what the line cannot tell.
      EXPECT_LE(comes.next({0.0, 0.0, -0.02 * frame}), 2) << "frame " << frame;
    }
  }
}

TEST(StaticPoints, WhoGetsUpIsOutWithinThreeFrames) {
  StaticPointsRun run(StaticPointMode::adaptive);
  for (int frame = 0; frame < 150; ++frame) run.next(Eigen::Vector3d::Zero());  // 5 s
  // Rises at 0.9 m a second, the speed reached within a fifth of a second.
  double height = 0.0;
  for (int frame = 1; frame <= 20; ++frame) {
    height += kFrameSeconds * 0.9 * std::min(1.0, frame / 6.0);
    const int back = run.next({0.0, -height, 0.0});
    if (frame >= 3) {
      EXPECT_LE(back, 2) << "frame " << frame << " after";
    }
  }
}

TEST(StaticPoints, SwitchedOffNothingComesBack) {
  StaticPointsRoom room;
  const FrameHistory history(60);
  StaticPoints off(room.camera(), {1.0}, {}, history);
  const auto features = room.features(0, Eigen::Vector3d::Zero());
  std::vector<char> movable(static_cast<std::size_t>(features->size()), 1);
  off.before_pose({0, 0.0, features, SE3{}}, movable);
  const FeaturePixels pixels;
  EXPECT_FALSE(off.between_poses({SE3{}, &pixels}, movable));
  EXPECT_EQ(std::count(movable.begin(), movable.end(), 1), features->size());
}

}  // namespace
}  // namespace penumbra::slam
