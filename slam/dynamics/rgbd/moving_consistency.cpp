#include "slam/dynamics/rgbd/moving_consistency.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "slam/dynamics/movable.h"

namespace penumbra::slam {

namespace {

constexpr int kSquare = 32, kBorder = 12;  // pixels
constexpr int kPatch = 2;                  // pixels on each side
constexpr int kMostDifference = 12;        // grey values, mean of a patch
constexpr int kFastThreshold = 12;         // grey values
constexpr int kLevels = 4, kIterations = 10;
constexpr double kSmallestStep = 0.05;  // pixels: what moves is off by 1
constexpr int kFewestStanding = 20;     // pairs that decide about the matrix

bool is_inside(const Size& image, double x, double y) {
  return x >= kBorder && y >= kBorder && x < image.width - kBorder && y < image.height - kBorder;
}

bool looks_alike(const ByteView& a, const FlowPoint& in_a, const ByteView& b, const FlowPoint& in_b) {
  const auto x_a = static_cast<int>(std::lround(in_a.x)), y_a = static_cast<int>(std::lround(in_a.y));
  const auto x_b = static_cast<int>(std::lround(in_b.x)), y_b = static_cast<int>(std::lround(in_b.y));
  int sum = 0;
  for (int y = -kPatch; y <= kPatch; ++y) {
    for (int x = -kPatch; x <= kPatch; ++x) sum += std::abs(a.at(x_a + x, y_a + y) - b.at(x_b + x, y_b + y));
  }
  constexpr int kPixels = (2 * kPatch + 1) * (2 * kPatch + 1);
  return sum <= kMostDifference * kPixels;
}

}  // namespace

const std::vector<PointMotions>& MovingConsistency::check(int frame, const ByteImage& grey,
                                                          std::span<const Instance> objects) {
  motions_.assign(objects.size(), {});
  if (grey.width() <= 2 * kBorder || grey.height() <= 2 * kBorder) return motions_;
  now_.build(grey, kLevels);
  const bool goes_on = frame > last_frame_ && frame - last_frame_ <= settings_.longest_gap;
  if (goes_on && !image_.empty() && image_.size() == grey.size()) follow(grey, objects);
  find_corners(grey);
  std::swap(last_, now_);
  image_ = grey;
  last_frame_ = frame;
  return motions_;
}

void MovingConsistency::follow(const ByteImage& grey, std::span<const Instance> objects) {
  moved_ = points_;
  FlowSettings flow;
  flow.levels = kLevels;
  flow.iterations = kIterations;
  flow.smallest_step = kSmallestStep;
  track_points(last_, now_, points_, moved_, flow);
  pairs_.clear();
  standing_.clear();
  movable_.clear();
  for (const Instance& object : objects) {
    if (is_movable_class(object.class_name)) movable_.push_back(object.region);
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const FlowPoint &from = points_[i], &to = moved_[i];
    if (!to.found || !is_inside(grey.size(), to.x, to.y) || !looks_alike(image_, from, grey, to)) continue;
    pairs_.push_back({{from.x, from.y}, {to.x, to.y}});
    const auto x = static_cast<int>(to.x), y = static_cast<int>(to.y);
    const auto hides = [&](const Rect& region) { return region.contains(x, y); };
    if (std::none_of(movable_.begin(), movable_.end(), hides)) standing_.push_back(pairs_.back());
  }
  const bool enough = static_cast<int>(standing_.size()) >= kFewestStanding;
  const std::optional<FundamentalResult> found = find_fundamental(enough ? standing_ : pairs_);
  if (!found) return;
  for (const PointPair& pair : pairs_) {
    const bool moves = epipolar_distance(found->F, pair) > settings_.threshold;
    const auto x = static_cast<int>(std::lround(pair.second.x()));
    const auto y = static_cast<int>(std::lround(pair.second.y()));
    for (std::size_t o = 0; o < objects.size(); ++o) {
      if (!objects[o].contains(x, y)) continue;
      ++motions_[o].followed;
      motions_[o].moving += moves;
    }
  }
}

// The points to follow next.
void MovingConsistency::find_corners(const ByteImage& grey) {
  points_.clear();
  const Rect inside{kBorder, kBorder, grey.width() - 2 * kBorder, grey.height() - 2 * kBorder};
  fast_.measure(grey, inside, kFastThreshold);
  for (int y = inside.y; y < inside.y + inside.height; y += kSquare) {
    for (int x = inside.x; x < inside.x + inside.width; x += kSquare) {
      corners_.clear();
      fast_.find(intersection({x, y, kSquare, kSquare}, inside), kFastThreshold, corners_);
      const auto best = std::max_element(corners_.begin(), corners_.end(),
                                         [](const Corner& a, const Corner& b) { return a.score < b.score; });
      if (best == corners_.end()) continue;
      points_.push_back({static_cast<float>(best->x), static_cast<float>(best->y), true});
    }
  }
}

}  // namespace penumbra::slam
