// How the camera moved from one frame to the next, told by the rim that something large leaves free of the
// view.
//
// Behind a lorry the left image shows a strip of the street on one side, the right image a wider one on the
// other, and hardly a point is in both: there is no stereo depth. So each image is compared with its own
// last one. A pair of features x1, x2 (normalised, of camera c) agrees with the step T = (R, t) where some
// depth explains it, along the ray from infinity to the nearest that anything can be:
//
//   y = R x1,  t_left = t,  t_right = t + b (R - I) e_x          the same step as the right camera makes it
//   e = f min over w of | pi(y + w t_c) - x2 |,   0 <= w <= 1 / 1.5 m;   w = 1 / z where x1 has stereo depth
//
// One number of each pair says something about the turn, and next to nothing about how far the camera went;
// that is what the motion so far leads to expect (PosePrior of the step). Where a bend begins or ends unseen
// the expected turn is wrong by degrees: so turns to both sides of it are tried first, and the one with the
// lowest sum of min(e^2 / sigma^2, gate) is improved by robust Gauss-Newton.
//
// Left out is everything that lies, row by row, between features on what moves: what covers the view stands
// still in it, and would have the camera stand still.
//
// Cost: 3 ms for 400 features an image. Source: two-view geometry, Hartley and Zisserman (2004), chapter 9;
// the prior and the bound on depth take the place of the unknown scale.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/pose_optimizer.h"

namespace penumbra::slam {

// The features of a frame that lie beside what moves.
struct RimView {
  Features left, right;
  std::vector<float> depth;  // metres, of the left ones; -1 unknown

  void clear() {
    left.clear();
    right.clear();
    depth.clear();
  }
  bool empty() const { return left.size() == 0 && right.size() == 0; }
};

struct RimSettings {
  double least_covered = 0.5;           // share of the image, from which on the rim is looked at
  int fewest_inliers = 20;              // pairs that agree with the step ...
  double least_agreeing = 0.5;          // ... and their share of all
  double metres = 0.1, radians = 0.01;  // what a step is worth that was found so
};

// `right`: of the right image.
void collect_rim(const FeatureView& features, const Features& right, RimView& rim);

// The step from `before` to `now`, T_now,before of the left cameras. `expected`: the same, by the motion so
// far, whose translation it keeps. Nothing where too few agree on one.
std::optional<SE3> rim_step(const StereoCamera& camera, std::span<const double> scales, const RimView& before,
                            const RimView& now, const PosePrior& expected, const RimSettings& settings);

}  // namespace penumbra::slam
