// Finds, without masks, what moves along with the camera: a lorry ahead fills the view and stands still in
// it.
//
// Features are compared with those of a frame half a second ago, near the same pixel and with about the same
// disparity. Where odometry says that the camera has moved, a feature that is found again there is either far
// away, or travels with the camera, or only looks like one that was there: a fence does. So the point is also
// looked for where it would be if it stood still, and travels only where it is much less like what is there:
//
//   D = X(t) - X(t_0),  S = cov X(t) + cov X(t_0)      stereo positions, metres, odometry's frame
//   travels: D^T S^-1 D > 9  and  |D| > v_least (t - t_0),   over t - t_0 >= seconds
// (Following features from frame to frame instead loses most of them on the way: a corner is found again with
// a probability of about 0.6 a frame.)
//
// The greatest cluster of travelling pixels is a companion if it has enough of them and most of the followed
// features in its outline travel, too. Cost: about 0.5 ms for 1000 features. The chi-square test is that of
// slam/dynamics/object_motion.h for single points.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "slam/dynamics/instance.h"
#include "slam/dynamics/point_origin.h"
#include "slam/geometry/se3.h"

namespace penumbra::slam {

struct CompanionSettings {
  bool enabled = true;
  double seconds = 0.35;        // over which a feature is watched at least ...
  double longest = 1.0;         // ... and at most
  double least_speed = 2.0;     // metres a second
  int fewest_features = 10;     // that travel
  double least_share = 0.6;     // of the followed features in the outline
  float search_radius = 20.0F;  // pixels
  double search_disparity = 3.0;
  int max_distance = 60;  // Hamming
  int margin = 20;        // by which a standing point must be less like it
};

class CompanionFinder {
 public:
  CompanionFinder(const StereoCamera& camera, const CompanionSettings& settings)
      : camera_(camera), settings_(settings) {}

  // Takes the next frame, with its pose in odometry's frame; `origins`: where its features are now, `known`
  // for those with stereo depth, `movable`: which are known to move already. Where the frame's pose is not
  // `reliable` the watch begins anew.
  std::optional<Instance> observe(std::shared_ptr<const FrameFeatures> features,
                                  std::shared_ptr<const FeaturePixels> pixels,
                                  const std::vector<char>& movable, std::vector<PointOrigin> origins,
                                  const SE3& T_co, double time, bool reliable);

 private:
  struct Past {
    std::shared_ptr<const FrameFeatures> features;
    std::shared_ptr<const FeaturePixels> pixels;
    std::vector<PointOrigin> origins;  // per feature
    double time = 0.0;

    FeatureView view() const { return {*features, pixels, {}}; }
  };
  struct Found {
    PointOrigin origin;
    bool clearly = false;  // where it would be if it stood still nothing looks like it
  };
  std::vector<Found> found_again(const Past& past, const FeatureView& features, const SE3& T_co) const;
  int distance_if_still(const Past& past, int i, const FeatureView& features, const SE3& T_co) const;

  const StereoCamera camera_;
  const CompanionSettings settings_;
  std::deque<Past> past_;
};

}  // namespace penumbra::slam
