// A made-up world for tests of everything behind the feature extraction: points with descriptors round a ring
// road, and what a camera sees of them, exactly, from any pose. No images, so a drive of a hundred keyframes
// takes milliseconds.
#pragma once

#include <memory>
#include <vector>

#include "slam/frontend/features/frame_features.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"

namespace penumbra::test {

class FeatureWorld {
 public:
  static constexpr double kRadius = 15.0;       // metres, of the road
  static constexpr int kKeyframesPerLap = 100;  // about a metre apart

  explicit FeatureWorld(std::uint64_t seed = 1);

  const slam::StereoCamera& camera() const { return camera_; }
  std::vector<double> scales() const;
  // The camera after `steps` keyframes, along the road; it began in the world's origin.
  slam::SE3 T_cw(double steps) const;
  const Eigen::Vector3d& point(int i) const { return points_[static_cast<std::size_t>(i)]; }
  // What is seen from there; `seen[i]` is the world's point that feature i shows. Pixels and descriptors
  // carry a little noise that depends on `noise_seed`.
  std::shared_ptr<slam::FrameFeatures> view(const slam::SE3& T_cw, std::uint64_t noise_seed,
                                            std::vector<int>& seen) const;

 private:
  slam::StereoCamera camera_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<slam::Descriptor> descriptors_;
};

// Builds a map of the world as a drifting odometry would: step by step its idea of the pose is `drift`
// farther off. Points are exact in the frame of the keyframe that sees them first. One that leaves the view
// becomes another map point when it is seen again.
class DriftingDrive {
 public:
  DriftingDrive(const FeatureWorld& world, slam::Map& map, const slam::Vector6d& drift)
      : world_(world), map_(map), drift_(drift) {}

  // The next keyframe, at `steps` along the road, where the drive thinks that it is.
  slam::KeyFrame* add_keyframe(double steps) { return add_keyframe(world_.T_cw(steps)); }
  // The next keyframe, truly at `T_cw`.
  slam::KeyFrame* add_keyframe(const slam::SE3& T_cw);
  // As if what was seen so far were not recognised any more.
  void forget() { tracked_.clear(); }
  // The same, and what comes is another sub-map.
  void begin_submap() {
    forget();
    new_submap_ = map_.begin_submap();
  }
  // From here on it believes to be `motion` (in the camera's frame) from where it did.
  void shift(const slam::Vector6d& motion) { shift_ = slam::SE3::exp(motion); }

 private:
  const FeatureWorld& world_;
  slam::Map& map_;
  slam::Vector6d drift_;
  slam::SE3 shift_;
  int new_submap_ = 0;  // 0: go on in the last one
  const slam::KeyFrame* last_ = nullptr;
  slam::SE3 last_T_cw_;  // its true pose
  int frames_ = 0;
  std::vector<slam::MapPoint*> tracked_;  // world's point -> map point that the last keyframe saw
};

}  // namespace penumbra::test
