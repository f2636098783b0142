// Which objects move, by what their points do from one image to the next: those that leave their epipolar
// lines.
//
//   corners of the last image (the best FAST corner of each square of 32 pixels)
//     -> where they are now, by pyramidal Lucas-Kanade (nn/image/point_flow.h)
//     -> left out: those within 12 pixels of the border, and those whose 5 x 5 pixels look different now
//     (mean
//        difference of grey values above 12): flow that went wrong, often at an edge in depth
//     -> fundamental matrix from the others, by RANSAC (slam/geometry/fundamental.h)
//     -> a point moves where its distance to its epipolar line is above 1 pixel
//     -> an object moves where at least 4 of its points, and 40 % of them, do
//
// Only points that are not on things which can move decide about the matrix: a person may fill half of the
// view. Against the paper, where all do. What moves along its epipolar line is not seen to move, nor anything
// where the camera only turns: then distances say little, and never too much. Cost: about 1.4 ms.
// Source: Yu et al., DS-SLAM (IROS 2018), section III-C, which Fang et al. take over.
#pragma once

#include <span>
#include <vector>

#include "nn/image/fast_corners.h"
#include "nn/image/point_flow.h"
#include "slam/dynamics/instance.h"
#include "slam/geometry/fundamental.h"

namespace penumbra::slam {

struct ConsistencySettings {
  bool enabled = true;
  double threshold = 1.0;    // pixels from the epipolar line
  int fewest_moving = 4;     // points of an object ...
  double least_share = 0.4;  // ... and of those that were followed
  int longest_gap = 5;       // frames between two images
};

// Of an object's points.
struct PointMotions {
  int followed = 0, moving = 0;
};

// One thread uses it; it repeats bit for bit.
class MovingConsistency {
 public:
  explicit MovingConsistency(const ConsistencySettings& settings) : settings_(settings) {}

  // Takes the next image (8-bit grey; its pixels are shared, not copied) and the objects in it. Nothing is
  // known of an object's points after the first image, a longer gap, or where no matrix was found.
  const std::vector<PointMotions>& check(int frame, const ByteImage& grey, std::span<const Instance> objects);
  // Whether enough points were followed to say anything.
  bool tells(const PointMotions& points) const { return points.followed >= settings_.fewest_moving; }
  bool moves(const PointMotions& points) const {
    return points.moving >= settings_.fewest_moving &&
           points.moving >= settings_.least_share * points.followed;
  }

 private:
  void follow(const ByteImage& grey, std::span<const Instance> objects);
  void find_corners(const ByteImage& grey);

  const ConsistencySettings settings_;
  int last_frame_ = 0;
  HalvingPyramid last_, now_;
  ByteImage image_;  // the last
  FastCorners fast_;
  std::vector<Corner> corners_;
  std::vector<FlowPoint> points_, moved_;
  std::vector<PointPair> pairs_, standing_;
  std::vector<Rect> movable_;  // boxes of things that can move
  std::vector<PointMotions> motions_;
};

}  // namespace penumbra::slam
