// How good masks are that come from boxes and depth (slam/dynamics/rgbd), and what a repair of the depth is
// worth, where the truth is known.
//
// Masks: IoU with the visible pixels of the object, by how it is seen:
//
//   behind   more than a quarter of its box is nearer than the object by 0.15 m or more
//   cut      else, where its box touches the border of the image
//   whole    else
//
// Repair: of the pixels in the boxes that had no depth, which got one, and how far it is from the truth. A
// hole is the object's or the background's by the mask. A hole of the background is filled wrongly where its
// depth is off by more than a tenth.
#pragma once

#include <string>
#include <vector>

#include "slam/dynamics/instance.h"
#include "slam/frontend/features/frame_features.h"

namespace penumbra::slam {

enum class ObjectView { whole, cut, behind };

// `truth`: its region is its box. `depth`: of the image, as good as there is, metres.
ObjectView view_of(const Instance& truth, const FloatImage& depth);

// Of two masks on the same image.
double mask_iou(const Instance& a, const Instance& b);

// A box as a detector may draw it: each side is off by at most `share` of the box's extent, evenly, and it
// ends at the image.
Rect jittered(const Rect& box, double share, std::uint64_t seed, const Size& image);

struct RepairCount {
  long holes = 0;       // of objects, whose true depth is known
  long filled = 0;      // of those
  double square = 0.0;  // sum of squared errors of those, metres^2
  long background = 0;  // holes of the background in the boxes
  long wrong = 0;       // of those, filled and off

  double filled_share() const {
    return holes > 0 ? static_cast<double>(filled) / static_cast<double>(holes) : 0.0;
  }
  double rmse() const;
  double wrong_share() const {
    return background > 0 ? static_cast<double>(wrong) / static_cast<double>(background) : 0.0;
  }
};

// Adds what a repair of `raw` to `repaired` did in an object's box; `clean`: the true depth. 0: unknown.
void count_repair(const Instance& truth, const FloatImage& raw, const FloatImage& repaired,
                  const FloatImage& clean, RepairCount& count);

// What became of the features with depth in people's boxes, of the body's and of others.
struct ForegroundCount {
  long body = 0, body_left = 0;              // left: not in the mask, so taken for the world's
  long background = 0, background_lost = 0;  // lost: in the mask

  double left_share() const {
    return body > 0 ? static_cast<double>(body_left) / static_cast<double>(body) : 0.0;
  }
  double lost_share() const {
    return background > 0 ? static_cast<double>(background_lost) / static_cast<double>(background) : 0.0;
  }
};

// Adds a person's box: `truth` is exact, `found` the mask that was made of the box.
void count_foreground(const Instance& truth, const Instance& found, const FrameFeatures& features,
                      ForegroundCount& count);

}  // namespace penumbra::slam
