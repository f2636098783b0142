#include "slam/evaluation/depth_mask_evaluation.h"

#include <algorithm>
#include <cmath>

#include "nn/base/counter_random.h"
#include "nn/base/quantile.h"

namespace penumbra::slam {

ObjectView view_of(const Instance& truth, const FloatImage& depth) {
  constexpr double kNearer = 0.15, kMuch = 0.25;  // metres, share of the box
  const Rect& box = truth.region;
  std::vector<double> own;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (truth.contains(x, y) && depth.at(x, y) > 0.0F) own.push_back(static_cast<double>(depth.at(x, y)));
    }
  }
  const double middle = quantile_of(std::move(own), 0.5);
  int nearer = 0;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const auto z = static_cast<double>(depth.at(x, y));
      nearer += !truth.contains(x, y) && z > 0.0 && z < middle - kNearer;
    }
  }
  if (nearer > kMuch * box.area()) return ObjectView::behind;
  const bool touches =
      box.x <= 0 || box.y <= 0 || box.x + box.width >= depth.width() || box.y + box.height >= depth.height();
  return touches ? ObjectView::cut : ObjectView::whole;
}

double mask_iou(const Instance& a, const Instance& b) {
  const Rect both = bounding(a.region, b.region);
  long shared = 0, joint = 0;
  for (int y = both.y; y < both.y + both.height; ++y) {
    for (int x = both.x; x < both.x + both.width; ++x) {
      const bool in_a = a.contains(x, y), in_b = b.contains(x, y);
      shared += in_a && in_b;
      joint += in_a || in_b;
    }
  }
  return joint == 0 ? 0.0 : static_cast<double>(shared) / static_cast<double>(joint);
}

Rect jittered(const Rect& box, double share, std::uint64_t seed, const Size& image) {
  const auto off = [&](std::uint64_t side, int length) {
    return static_cast<int>(std::lround(share * length * (2.0 * counter_uniform(seed, side) - 1.0)));
  };
  const int left = box.x + off(0, box.width), right = box.x + box.width + off(1, box.width);
  const int top = box.y + off(2, box.height), bottom = box.y + box.height + off(3, box.height);
  return intersection({left, top, std::max(1, right - left), std::max(1, bottom - top)},
                      {0, 0, image.width, image.height});
}

double RepairCount::rmse() const {
  return filled > 0 ? std::sqrt(square / static_cast<double>(filled)) : 0.0;
}

void count_repair(const Instance& truth, const FloatImage& raw, const FloatImage& repaired,
                  const FloatImage& clean, RepairCount& count) {
  constexpr float kWrong = 0.1F;  // of the true depth
  const Rect& box = truth.region;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const float z = clean.at(x, y), now = repaired.at(x, y);
      if (raw.at(x, y) > 0.0F || !(z > 0.0F)) continue;
      const bool is_filled = now > 0.0F;
      if (truth.contains(x, y)) {
        ++count.holes;
        count.filled += is_filled;
        if (is_filled) count.square += static_cast<double>((now - z) * (now - z));
      } else {
        ++count.background;
        count.wrong += is_filled && std::abs(now - z) > kWrong * z;
      }
    }
  }
}

void count_foreground(const Instance& truth, const Instance& found, const FrameFeatures& features,
                      ForegroundCount& count) {
  for (int i = 0; i < features.size(); ++i) {
    const Keypoint& k = features.keypoint(i);
    const int x = static_cast<int>(k.u), y = static_cast<int>(k.v);
    if (!found.region.contains(x, y) || !(features.depth[static_cast<std::size_t>(i)] > 0.0F)) continue;
    const bool inside = found.contains(x, y);
    if (truth.contains(x, y)) {
      ++count.body;
      count.body_left += !inside;
    } else {
      ++count.background;
      count.background_lost += inside;
    }
  }
}

}  // namespace penumbra::slam
